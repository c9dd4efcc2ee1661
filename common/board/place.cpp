#include "common/board/place.hpp"

#include <sstream>
#include <string_view>

#include "common/base/error.hpp"
#include "common/excitation/supervisor.hpp"
#include "common/model/site.hpp"
#include "common/model/vehicle_file.hpp"

namespace fathom::board {

void Place::take(const Config& file) {
  if (file.has("dof")) {
    const model::Vehicle read = model::vehicle_from(file);
    vehicle = read.name;
    hull = read.hull;
    thrusters.clear();
    for (const model::Thruster& each : read.thrusters) thrusters.push_back(each.name);
    vehicle_file_ = file;
  }
  if (file.has("site") && !file.is_section("site")) {
    const model::Site read = model::Site::from(file);
    site = read.name;
    walls = Bounds{{read.south, read.west}, {read.north, read.east}};
    surface = read.surface;
    floor = read.floor;
    tags.clear();
    for (const model::Tag& each : read.tags) tags.push_back(each.p_WT);
    transponders.clear();
    for (const model::Transponder& each : read.transponders) transponders.push_back(each.p_W);
    tether_anchor = read.tether_anchor;
    site_file_ = file;
  }
  if (file.is_section("supervisor")) supervisor_ = file.section("supervisor");
  find_fence();
}

// As the supervisor itself makes it of the same three files.
void Place::find_fence() {
  if (!vehicle_file_ || !site_file_ || !supervisor_) return;
  const auto settings = excitation::SupervisorSettings::from(*supervisor_, model::vehicle_from(*vehicle_file_),
                                                             model::Site::from(*site_file_));
  fence = Bounds{settings.fence.low.head<2>(), settings.fence.high.head<2>()};
}

bool Place::take_told(const std::string& config) {
  constexpr std::string_view kHead = "# file ";
  std::istringstream text{config};
  std::string name, body;
  bool any = false;
  const auto take_one = [&] {
    if (!name.empty()) {
      try {
        take(Config::parse(body, name));
        any = true;
      } catch (const InputError&) {  // another version's, or the operator's, which is not told
      }
    }
    body.clear();
  };
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(kHead)) {
      take_one();
      name = line.substr(kHead.size());
    } else {
      body += line + "\n";
    }
  }
  take_one();
  return any;
}

}  // namespace fathom::board
