// Two families whose ids overlap, through the programs: fathom track, fathom calibrate, camera_driver and vision.
#include "test/common/vision/two_families.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "common/wire/log_reader.hpp"
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

constexpr int kPictures = 24;
constexpr double kPlace = 0.01;  // m: tags at 1.3 m, 0.2 px, JPEG

vision::Pose along(int i) {
  return pose({0.09 * i - 1.0, 0.1 * std::sin(i), 0.15 + 0.05 * std::cos(0.7 * i)}, 0.1 * std::sin(2.1 * i),
              0.1 * std::cos(1.3 * i), 0.1 * i);
}

struct Scene {
  Scratch scratch;
  std::string pictures = scratch.path("pictures"), site = scratch.path("two.yaml");
  std::string vehicle = file("config/vehicles/seabotix_lbv150.yaml");

  Scene() {
    std::ofstream{site} << two_families_text();
    write_pictures(vision::Renderer{two_families(), lens(), std::nullopt, {}, 51}, pictures, kPictures, along);
  }
  [[nodiscard]] test::Ran track(const std::string& map, const std::string& more = "") const {
    return shell(program("fathom") + " track " + pictures + " --site " + map + " --vehicle " + vehicle + " --csv " +
                 scratch.path("out.csv") + more);
  }
};

std::vector<std::vector<std::string>> rows(const std::string& path) {
  std::ifstream in{path};
  std::vector<std::vector<std::string>> all;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words{line};
    all.emplace_back();
    for (std::string cell; std::getline(words, cell, ',');) all.back().push_back(cell);
  }
  return all;
}

/// Family and verdict of the table of detections.
std::map<std::pair<std::string, std::string>, int> detections(const std::string& path) {
  std::map<std::pair<std::string, std::string>, int> count;
  for (const auto& row : rows(path)) ++count[{row.at(1), row.at(13)}];
  return count;
}

double worst_place(const std::string& path) {
  const auto table = rows(path);
  REQUIRE(table.size() == kPictures + 1);
  const auto at = static_cast<std::size_t>(std::ranges::find(table[0], "p_WC_x_m") - table[0].begin());
  double worst = 0.0;
  for (int i = 0; i < kPictures; ++i) {
    const auto& row = table[static_cast<std::size_t>(i) + 1];
    const Eigen::Vector3d p{std::stod(row.at(at)), std::stod(row.at(at + 1)), std::stod(row.at(at + 2))};
    worst = std::max(worst, (p - along(i).p_WC).norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("two families: fathom track knows every tag, fathom calibrate surveys both and its map is as good") {
  const Scene scene;
  const auto ran = scene.track(scene.site);
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  auto seen = detections(scene.scratch.path("out.csv"));
  CHECK(seen[{"tag36h11", "accepted"}] > kPictures);
  CHECK(seen[{"tag16h5", "accepted"}] > kPictures);
  CHECK(seen[{"tag16h5", "outside the map"}] == 0);
  CHECK(worst_place(scene.scratch.path("out.frames.csv")) < kPlace);

  // The second poster is not in the map: placed by the first, under numbers of its own.
  std::string first = two_families_text();
  first.erase(first.find("  - {first: 0, family"));
  std::ofstream{scene.scratch.path("first.yaml")} << first;
  const auto survey =
      shell(program("fathom") + " calibrate " + scene.pictures + " --site " + scene.scratch.path("first.yaml") +
            " --vehicle " + scene.vehicle + " --adjust map --size 0.15 --out " + scene.scratch.path("surveyed.yaml") +
            " --picture " + scene.scratch.path("survey.png"));
  REQUIRE_MESSAGE(survey.code == 0, survey.text);
  const model::Site surveyed = model::Site::load(scene.scratch.path("surveyed.yaml")), truth = two_families();
  int placed = 0;
  for (const model::Tag& tag : surveyed.tags) {
    const model::Tag* real = truth.tag(surveyed.family_of(tag), tag.id);
    REQUIRE(real != nullptr);
    placed += tag.number() >= kSecondNumber ? 1 : 0;
    CHECK((tag.p_WT - real->p_WT).norm() < kPlace);
  }
  CHECK(placed >= 8);
  const auto again = scene.track(scene.scratch.path("surveyed.yaml"));
  REQUIRE_MESSAGE(again.code == 0, again.text);
  CHECK(worst_place(scene.scratch.path("out.frames.csv")) < kPlace);
  // Looking for one family alone, its own map counts.
  const auto second = scene.track(scene.site, " --families tag16h5");
  REQUIRE_MESSAGE(second.code == 0, second.text);
  auto alone = detections(scene.scratch.path("out.csv"));
  CHECK(alone[{"tag16h5", "accepted"}] > kPictures);
  CHECK(alone[{"tag36h11", "accepted"}] == 0);
}

TEST_CASE("two families: TAG_POSE tells tags of one id apart") {
  const Scene scene;
  std::ofstream{scene.scratch.path("camera.yaml")} << "camera_driver: {camera: down, pictures: " << scene.pictures
                                                   << ", rate: 10 Hz}\n";
  const auto drove = shell(program("camera_driver") + " --log-level error --config " +
                           scene.scratch.path("camera.yaml") + " --out file://" + scene.scratch.path("camera.lcmlog"));
  REQUIRE_MESSAGE(drove.code == 0, drove.text);
  const auto ran = shell(program("vision") + " --log-level warning --config " + file("config/pipelines/tank.yaml") +
                         " --config " + scene.vehicle + " --config " + scene.site + " --in file://" +
                         scene.scratch.path("camera.lcmlog") + " --out file://" + scene.scratch.path("seen.lcmlog"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const Recording recording = wire::read_log(scene.scratch.path("seen.lcmlog")).recording;
  const model::Site place = two_families();
  std::set<Utime> pictures;
  std::set<int> ids, numbers;
  for (const TagPose& each : recording.tag_pose) {
    pictures.insert(each.utime);
    const model::Tag* tag = place.tag(each.tag);
    REQUIRE(tag != nullptr);
    numbers.insert(each.tag);
    ids.insert(tag->id);
    const vision::Pose truth = along(static_cast<int>(pictures.size()) - 1);
    CHECK((each.p_CT - truth.R_WC.transpose() * (tag->p_WT - truth.p_WC)).norm() < kPlace);
  }
  CHECK(pictures.size() == kPictures);
  CHECK(numbers.size() > ids.size());
}

}  // namespace fathom
