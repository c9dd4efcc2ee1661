// Sites and mounts: what the repository's files say, and what is refused.
#include "common/model/site.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/mounts.hpp"
#include "common/model/vehicle.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using namespace fathom::model;

namespace {

const std::string kSites = std::string{FATHOM_SOURCE_DIR} + "/config/sites/";
constexpr double kExact = 1e-12;

std::string complaint(const std::string& from, const std::string& to) {
  const test::Scratch scratch;
  std::string text = test::read_bytes(kSites + "tank.yaml");
  REQUIRE(text.find(from) != std::string::npos);
  text.replace(text.find(from), from.size(), to);
  test::write_bytes(scratch.path("site.yaml"), text);
  return test::complaint_of<InputError>([&] { static_cast<void>(Site::load(scratch.path("site.yaml"))); });
}

std::string mount_complaint(const std::string& text) {
  return test::complaint_of<InputError>([&] {
    const Config config = Config::parse(text, "v.yaml");
    static_cast<void>(Mounts::from(config));
    config.finish();
  });
}

}  // namespace

TEST_CASE("site: the paper's tank, its poster on the floor readable from above with north on top") {
  const Site tank = Site::load(kSites + "tank.yaml");
  CHECK(tank.north - tank.south == 5.0);
  CHECK(tank.east - tank.west == 3.0);
  CHECK(tank.depth() == 1.5);
  CHECK_FALSE(tank.transceiver);
  REQUIRE(tank.tags.size() == 45);
  // The first is at the top left: north-west. Numbers rise to the east, then to the south.
  CHECK((tank.tag(0)->p_WT - Eigen::Vector3d{1.8, -0.9, 1.5}).norm() < kExact);
  CHECK((tank.tag(1)->p_WT - Eigen::Vector3d{1.8, -0.45, 1.5}).norm() < kExact);
  CHECK((tank.tag(5)->p_WT - Eigen::Vector3d{1.35, -0.9, 1.5}).norm() < kExact);
  CHECK((tank.tag(0)->R_WT.col(0) - Eigen::Vector3d::UnitY()).norm() < kExact);  // x: east
  CHECK((tank.tag(0)->R_WT.col(1) + Eigen::Vector3d::UnitX()).norm() < kExact);  // y: south
  CHECK((tank.tag(0)->R_WT.col(2) - Eigen::Vector3d::UnitZ()).norm() < kExact);  // z: into the floor
  CHECK(tank.tag(45) == nullptr);
}

TEST_CASE("site: for pictures alone water may be missing, and a number that two tags have costs these two") {
  const test::Scratch scratch;
  const std::string path = scratch.path("site.yaml");
  const std::string tag = ", size: 0.1 m, position: 1 2 0 m, rotation: 0 0 0 deg}\n";
  test::write_bytes(path,
                    "site: x\ntag_search: {families: [tag16h5], map_sigma: 1 cm, least_margin: 9}\n"
                    "camera: {width: 640, height: 480, focal: 500}\ntags:\n  - {id: 3" +
                        tag + "  - {id: 4" + tag + "  - {id: 3" + tag);
  CHECK_THROWS_AS(static_cast<void>(Site::load(path)), InputError);
  const Site site = Site::load_for_pictures(path);
  CHECK(site.search.families == std::vector<std::string>{"tag16h5"});
  CHECK(site.search.map_sigma == 0.01);
  CHECK(site.search.least_margin == 9.0);
  REQUIRE(site.lens);
  CHECK(site.lens->cx == 319.5);
  CHECK(site.doubtful_tags == std::vector<TagName>{{"tag16h5", 3}});
  REQUIRE(site.tags.size() == 1);
  CHECK(site.tags.front().id == 4);
}

TEST_CASE("site: two families whose ids overlap; what stands twice is refused, and of what TAG_POSE could not tell") {
  const test::Scratch scratch;
  const std::string path = scratch.path("site.yaml");
  const auto load = [&](const std::string& tags) {
    test::write_bytes(path, "site: x\ntag_search: {families: [tag36h11, tag16h5]}\n" + tags);
    return Site::load_for_pictures(path);
  };
  const auto refused = [&](const std::string& tags) {
    return test::complaint_of<InputError>([&] { static_cast<void>(load(tags)); });
  };
  const std::string rows = "rows: 1, columns: 2, size: 0.1 m, pitch: 0.2 m, rotation: 0 0 0 deg";
  const std::string first = "poster:\n  - {first: 3, middle: 0 0 0 m, " + rows + "}\n";
  const Site site = load(first + "  - {first: 3, family: 16h5, number: 100, middle: 1 0 0 m, " + rows + "}\n");
  REQUIRE(site.tags.size() == 4);
  CHECK(site.doubts().empty());
  CHECK(site.tag("tag36h11", 4) == site.tag(4));
  CHECK(site.tag("tag16h5", 4) == site.tag(101));
  CHECK(site.tag(101)->p_WT.x() == doctest::Approx(1.1));
  CHECK(site.tag("tag25h9", 4) == nullptr);
  Site others = site;
  others.look_for({"tag16h5"});  // those of the first family do not become the second's
  CHECK(others.tag("tag16h5", 4)->number() == 101);

  const std::string same = "  - {first: 4, family: tag16h5, middle: 1 0 0 m, " + rows + "}\n";
  CHECK(refused(first + same).find("site.yaml:5: tag 4 of tag16h5 and tag 4 of tag36h11 would both be number 4") !=
        std::string::npos);
  CHECK(refused(first + "  - {first: 4, family: tag25h9, middle: 1 0 0 m, " + rows + "}\n")
            .find("'tag_search' does not name tag25h9") != std::string::npos);
  const std::string again = "  - {first: 5, family: 16h5, number: 9, middle: 1 0 0 m, " + rows + "}\n";
  const Site twice = load(first + again + again);
  CHECK(twice.doubts() == "the site's map has two tags of number 5 (16h5), 6 (16h5): neither is used");
  CHECK(twice.tags.size() == 2);
}

TEST_CASE("site: open water has no walls, a transceiver and transponders") {
  const Site deep = Site::load(kSites + "deep.yaml");
  CHECK(std::isinf(deep.north));
  CHECK(std::isinf(deep.west));
  CHECK(deep.tags.empty());
  REQUIRE(deep.transceiver);
  CHECK(deep.transponders.size() == 5);
  CHECK(deep.depth() == 60.0);
}

TEST_CASE("site: bad lines are refused with their number") {
  CHECK(complaint("floor: 1.5 m}", "floor: -1.5 m}").find("site.yaml:4: 'floor' must lie below the surface") !=
        std::string::npos);
  CHECK(complaint("north: 2.5 m", "north: -3 m").find("the north wall must lie north of the south wall") !=
        std::string::npos);
  CHECK(complaint("density: 998 kg/m^3", "density: 998").find("density") != std::string::npos);
  CHECK(complaint("pitch: 0.45 m", "pitch: 0.1 m").find("the tags overlap") != std::string::npos);
  CHECK(complaint("declination", "declinatoin").find("did you mean 'declination'") != std::string::npos);
  CHECK(complaint("rows: 9", "rows: 0").find("'rows' must be positive") != std::string::npos);
  CHECK(complaint("poster:", "tags: [{id: 3, size: 0.1 m, position: 0 0 1 m, rotation: 0 0 0 deg}]\nposter:")
            .find("two tags have the number 3") != std::string::npos);
}

TEST_CASE("mounts: a camera that looks down with the picture's top ahead; a velocity log turned by 45 degrees") {
  const Vehicle vehicle = Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/seabotix_lbv150.yaml");
  const CameraMount* camera = vehicle.mounts.camera("down");
  REQUIRE(camera != nullptr);
  CHECK((camera->mount.R_BS.col(0) - Eigen::Vector3d::UnitY()).norm() < kExact);
  CHECK((camera->mount.R_BS.col(1) + Eigen::Vector3d::UnitX()).norm() < kExact);
  CHECK((camera->mount.R_BS.col(2) - Eigen::Vector3d::UnitZ()).norm() < kExact);
  CHECK(std::abs(vehicle.mounts.dvl->mount.R_BS(0, 0) - std::sqrt(0.5)) < kExact);
  CHECK(vehicle.mounts.loads.size() == 3);
  CHECK(vehicle.mounts.camera("up") == nullptr);
}

TEST_CASE("mounts: bad lines are refused with their number") {
  const std::string camera = "cameras: [{name: a, position: 0 0 0 m, width: 640, height: 480, focal: 500}]\n";
  CHECK(mount_complaint(camera + "laser: {camera: b, emitter: 0 0 0 m, axis: 0 0 1}").find("no camera is called 'b'") !=
        std::string::npos);
  CHECK(mount_complaint(camera + "laser: {camera: a, emitter: 0 0 0 m, axis: 0 0 2}").find("must be a unit vector") !=
        std::string::npos);
  CHECK(mount_complaint("ahrs: {position: 0 0 m}").find("v.yaml:1: 'position' must be three numbers") !=
        std::string::npos);
  CHECK(mount_complaint("dvl: {position: 0 0 0 m, beam_angle: 95 deg}").find("stays below 90 deg") !=
        std::string::npos);
  CHECK(mount_complaint("depht: {position: 0 0 0 m}").find("did you mean 'depth'") != std::string::npos);
}
