// From an unknown lens and a map by tape measure to a pose: fathom calibrate for the lens, for the map, fathom track.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "test/common/vision/picture_folder.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;
using namespace vision::test_scene;

/// What the vehicle file does not know: a longer focal length, another centre, a barrel.
model::Lens real_lens() {
  return {.width = 640, .height = 480, .fx = 585, .fy = 582, .cx = 327, .cy = 231, .distortion = {-0.12, 0.03}};
}

/// The map of the site, and where its tags really lie: up to 3 cm off and turned.
model::Site real_floor(const model::Site& planned) {
  model::Site real = planned;
  for (model::Tag& tag : real.tags) {
    const double a = 1.7 * tag.id;
    tag.p_WT += Eigen::Vector3d{0.03 * std::sin(a), 0.03 * std::cos(1.3 * a), 0.0};
    tag.R_WT = tag.R_WT * rotation_from_euler({0.0, 0.0, 0.03 * std::sin(0.6 * a)});
  }
  return real;
}

template <class PoseAt>
void take(const model::Site& place, const std::string& folder, int n, PoseAt pose_at) {
  write_pictures(vision::Renderer{place, real_lens(), std::nullopt, {}, 31}, folder, n, pose_at);
}

vision::Pose over_board(int i) {
  return pose({0.3 * std::sin(i), 0.2 * std::cos(1.7 * i), 0.1 + 0.06 * (i % 10)}, 0.45 * std::sin(2.1 * i),
              0.45 * std::cos(1.3 * i), 0.7 * i);
}
vision::Pose along_floor(int i) {
  return pose({1.2 * std::sin(0.21 * i), 0.8 * std::cos(0.33 * i), 0.2 + 0.1 * std::sin(i)}, 0.1 * std::sin(2.1 * i),
              0.1 * std::cos(1.3 * i), 0.2 * i);
}

std::string text_of(const std::string& path) {
  std::ifstream in{path};
  return {std::istreambuf_iterator<char>{in}, {}};
}

/// Column of the frames' table by its name, NaN where it is empty.
std::vector<double> column(const std::string& path, const std::string& name) {
  std::ifstream in{path};
  std::string line, cell;
  std::getline(in, line);
  std::size_t at = 0;
  for (std::istringstream words{line}; std::getline(words, cell, ',') && cell != name;) ++at;
  std::vector<double> values;
  while (std::getline(in, line)) {
    std::istringstream words{line};
    for (std::size_t i = 0; i <= at; ++i) std::getline(words, cell, ',');
    values.push_back(cell.empty() ? NAN : std::stod(cell));
  }
  return values;
}

struct PlaceErrors {
  double worst{};
  int known{};
};

PlaceErrors errors(const std::string& frames) {
  const auto x = column(frames, "p_WC_x_m"), y = column(frames, "p_WC_y_m"), z = column(frames, "p_WC_z_m");
  PlaceErrors result;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i])) continue;
    ++result.known;
    const Eigen::Vector3d truth = along_floor(static_cast<int>(i)).p_WC;
    result.worst = std::max(result.worst, (Eigen::Vector3d{x[i], y[i], z[i]} - truth).norm());
  }
  return result;
}

}  // namespace

TEST_CASE("fathom calibrate: lens from a board, map from the floor, and the pose is the truth") {
  constexpr double kPlace = 0.012, kFocal = 3.0;  // m, of the worst pose; px
  constexpr int kBoard = 30, kFloor = 60;
  const Scratch scratch;
  const std::string planned = std::string{FATHOM_SOURCE_DIR} + "/config/sites/tank.yaml";
  const std::string vehicle = std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/seabotix_lbv150.yaml";
  take(site(), scratch.path("board"), kBoard, over_board);
  const model::Site plan = model::Site::load(planned);
  take(real_floor(plan), scratch.path("floor"), kFloor, along_floor);

  // The board: a poster, exact as a printer makes it.
  std::ofstream{scratch.path("board.yaml")} << "site: board\ntag_search: {families: [tag36h11], map_sigma: 0 mm}\n"
                                               "poster: {first: 0, rows: 5, columns: 5, size: 0.15 m, pitch: 0.45 m,\n"
                                               "  middle: 0 0 1.5 m, rotation: 0 0 0 deg}\n";
  const auto lens = shell(program("fathom") + " calibrate " + scratch.path("board") + " --site " +
                          scratch.path("board.yaml") + " --vehicle " + vehicle + " --adjust lens --out " +
                          scratch.path("lens.yaml") + " --picture " + scratch.path("lens.png"));
  REQUIRE_MESSAGE(lens.code == 0, lens.text);
  const std::string told = "camera 'down': ";
  const auto from = lens.text.find(told);
  REQUIRE_MESSAGE(from != std::string::npos, lens.text);
  const std::string keys = lens.text.substr(from + told.size(), lens.text.find('\n', from) - from - told.size());
  std::string file_text = text_of(vehicle);
  const std::string old_keys = "width: 640, height: 480, focal: 540";
  const auto at = file_text.find(old_keys);
  REQUIRE(at != std::string::npos);
  file_text.replace(at, old_keys.size(), keys);
  std::ofstream{scratch.path("vehicle.yaml")} << file_text;
  const model::Site with_lens = model::Site::load_for_pictures(scratch.path("lens.yaml"));
  REQUIRE(with_lens.lens);
  CHECK(std::abs(with_lens.lens->fx - real_lens().fx) < kFocal);
  CHECK(std::abs(with_lens.lens->fy - real_lens().fy) < kFocal);
  CHECK(std::abs(with_lens.lens->cx - real_lens().cx) < kFocal);
  CHECK(std::abs(with_lens.lens->cy - real_lens().cy) < kFocal);

  // The floor, with the lens that is now known; the plan is a few centimetres off.
  const std::string own = " --vehicle " + scratch.path("vehicle.yaml");
  const auto survey = shell(program("fathom") + " calibrate " + scratch.path("floor") + " --site " + planned + own +
                            " --adjust map --map-sigma 0.03 --out " + scratch.path("surveyed.yaml") + " --hold-out 5");
  REQUIRE_MESSAGE(survey.code == 0, survey.text);
  // Water, walls and what else the site says are still there: a pipeline can use it as it is.
  const model::Site surveyed = model::Site::load(scratch.path("surveyed.yaml"));
  CHECK(surveyed.water_density == plan.water_density);
  CHECK(surveyed.north == plan.north);
  CHECK(surveyed.tether_anchor == plan.tether_anchor);
  CHECK(surveyed.tags.size() == plan.tags.size());
  const auto ready = shell(program("vision") + " --interface --config " + file("config/pipelines/tank.yaml") +
                           " --config " + scratch.path("vehicle.yaml") + " --config " + scratch.path("surveyed.yaml"));
  CHECK_MESSAGE(ready.code == 0, ready.text);

  const auto track = [&](const std::string& which, const std::string& with) {
    const auto ran = shell(program("fathom") + " track " + scratch.path("floor") + " --site " + which + " --vehicle " +
                           with + " --csv " + scratch.path("out.csv"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    return errors(scratch.path("out.frames.csv"));
  };
  const auto strict = shell(program("fathom") + " calibrate " + scratch.path("floor") + " --site " + planned + own +
                            " --adjust map --map-sigma 0.002 --out " + scratch.path("strict.yaml"));
  CHECK_MESSAGE(strict.says("is it known no better than --map-sigma?"), strict.text);
  const PlaceErrors before = track(planned, vehicle),
                    after = track(scratch.path("surveyed.yaml"), scratch.path("vehicle.yaml"));
  MESSAGE("worst place of the camera [m]: before " << before.worst << " of " << before.known << ", after "
                                                   << after.worst << " of " << after.known);
  CHECK(after.known > kFloor * 9 / 10);
  CHECK(after.worst < kPlace);
  CHECK(after.worst < 0.3 * before.worst);
  // A map that brings its own lens beside another one in the vehicle file: said.
  const auto two = shell(program("fathom") + " track " + scratch.path("floor") + " --site " +
                         scratch.path("surveyed.yaml") + " --vehicle " + vehicle + " --csv " + scratch.path("out.csv"));
  CHECK(two.code == 0);
  CHECK_MESSAGE(two.says("state different lenses"), two.text);
}

}  // namespace fathom
