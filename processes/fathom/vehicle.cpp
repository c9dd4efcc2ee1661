// fathom vehicle: the vehicle files that come with Fathom, to begin one's own with, and drafts of one from a drawing or
// a frame.
#include "common/model/vehicle.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/motions.hpp"
#include "common/base/near_name.hpp"
#include "common/drafts/ardusub_frames.hpp"
#include "common/drafts/draft.hpp"
#include "common/drafts/robot.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

namespace fs = std::filesystem;

/// config/vehicles beside the installed programs, or in the tree in which they were built.
fs::path folder() {
  std::error_code unknown;
  const fs::path programs = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  const fs::path installed = programs.parent_path() / "share" / "fathom" / "config" / "vehicles";
  if (fs::is_directory(installed, unknown)) return installed;
  for (fs::path each = programs; each != each.root_path(); each = each.parent_path()) {
    if (fs::is_directory(each / "config" / "vehicles", unknown)) return each / "config" / "vehicles";
  }
  throw InputError(programs.string() +
                   ": the vehicle files (share/fathom/config/vehicles) are not where this program is");
}

/// By the name under which it is asked for.
std::map<std::string, fs::path> files() {
  std::map<std::string, fs::path> found;
  for (const auto& entry : fs::directory_iterator{folder()}) {
    if (entry.path().extension() == ".yaml") found[entry.path().stem().string()] = entry.path();
  }
  return found;
}

std::string motions(const model::Vehicle& vehicle) {
  std::string text;
  for (std::size_t i = 0; i < kMotionNames.size(); ++i) {
    if (vehicle.dof[i]) text += (text.empty() ? "" : " ") + std::string{kMotionNames[i]};
  }
  return text;
}

void list() {
  for (const auto& [name, path] : files()) {
    const model::Vehicle vehicle = model::Vehicle::load(path.string());
    const std::string driven =
        vehicle.has_thrusters() ? std::to_string(vehicle.thrusters.size()) + " thrusters" : "wrench";
    std::printf("%-16s %-24s %6.1f kg  %-11s  %s\n", name.c_str(), vehicle.name.c_str(), vehicle.mass, driven.c_str(),
                motions(vehicle).c_str());
  }
  std::printf("\nfathom vehicle NAME > my.yaml: sources and certainty of the numbers stand in the file\n");
}

void print(const std::string& name) {
  const std::map<std::string, fs::path> known = files();
  const auto found = known.find(name);
  if (found == known.end()) {
    std::string all, near;
    for (const auto& [each, path] : known) {
      all += (all.empty() ? "" : ", ") + each;
      if (near.empty() && looks_like(name, each)) near = " (did you mean " + each + "?)";
    }
    throw InputError("no vehicle file is called " + name + near + "; there are: " + all);
  }
  std::ifstream file{found->second, std::ios::binary};
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw InputError(found->second.string() + ": cannot be read");
  std::fputs(text.str().c_str(), stdout);
}

struct VehicleOptions {
  std::string name, sdf, urdf, frame;
  std::vector<std::string> places;
};

/// "3:-0.12,0.22,0": motor output and place.
std::map<int, Eigen::Vector3d> places_of(const std::vector<std::string>& words) {
  std::map<int, Eigen::Vector3d> places;
  for (const std::string& word : words) {
    int number = 0, end = 0;
    double x = 0.0, y = 0.0, z = 0.0;
    const int read = std::sscanf(word.c_str(), "%d:%lf,%lf,%lf%n", &number, &x, &y, &z, &end);
    if (read != 4 || static_cast<std::size_t>(end) != word.size() || !Eigen::Vector3d{x, y, z}.allFinite()) {
      throw InputError("--place " + word + ": is MOTOR:FORWARD,RIGHT,DOWN in m, as in 1:0.156,0.111,0.085");
    }
    if (!places.emplace(number, Eigen::Vector3d{x, y, z}).second)
      throw InputError("--place " + word + ": this motor has a place already");
  }
  return places;
}

void draft(const VehicleOptions& options) {
  const int asked = (options.name.empty() ? 0 : 1) + (options.sdf.empty() ? 0 : 1) + (options.urdf.empty() ? 0 : 1) +
                    (options.frame.empty() ? 0 : 1);
  if (asked > 1) throw InputError("one of NAME, --from-sdf, --from-urdf and --from-ardusub-frame at a time");
  if (!options.places.empty() && options.frame.empty()) throw InputError("--place: goes with --from-ardusub-frame");
  std::string text;
  if (!options.frame.empty()) text = vehicle_file(drafts::draft_of_frame(options.frame, places_of(options.places)));
  if (!options.sdf.empty())
    text = vehicle_file(draft_of(drafts::read_sdf(options.sdf), fs::path{options.sdf}.filename().string()));
  if (!options.urdf.empty())
    text = vehicle_file(draft_of(drafts::read_urdf(options.urdf), fs::path{options.urdf}.filename().string()));
  if (!text.empty()) std::fputs(text.c_str(), stdout);
}

}  // namespace

void add_vehicle(runtime::CommandLine& app) {
  auto options = std::make_shared<VehicleOptions>();
  runtime::CommandLine* command = app.add_subcommand("vehicle", "vehicle files to begin with: all of them, or one");
  command->add_option("name", options->name, "which file to print; without: a list");
  command->add_option("--from-sdf", options->sdf, "print one from a model of Gazebo: mass, inertia, thrusters");
  command->add_option("--from-urdf", options->urdf,
                      "print one from a URDF with thrusters as Gazebo's plugins or joints");
  command->add_option("--from-ardusub-frame", options->frame,
                      "print one with the motors of ArduSub's frame, as in vectored-6dof");
  command
      ->add_option("--place", options->places,
                   "where a motor of the frame sits, MOTOR:FORWARD,RIGHT,DOWN in m; once for each")
      ->take_all()
      ->expected(1);
  command->callback([options] {
    draft(*options);
    if (!options->sdf.empty() || !options->urdf.empty() || !options->frame.empty()) return;
    options->name.empty() ? list() : print(options->name);
  });
}

}  // namespace fathom::tool
