#include "common/model/mounts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/config.hpp"
#include "common/base/spatial.hpp"
#include "common/model/priors/bounded.hpp"
#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {
namespace {

constexpr double kUnitTolerance = 0.01;  // an axis typed with three digits is still a unit vector

Eigen::Vector3d axis(const Config& config, const std::string& key) {
  const Eigen::Vector3d given = bounded::vector3(config, key, "");
  if (std::abs(given.norm() - 1.0) > kUnitTolerance) config.fail(key, "'" + key + "' must be a unit vector");
  return given.normalized();
}

Mount mount(const Config& config) {
  Mount result{.p_BS = bounded::vector3(config, "position", "m")};
  if (config.has("rotation")) result.R_BS = rotation_from_euler(bounded::vector3(config, "rotation", "rad"));
  return result;
}

CameraMount camera_mount(const Config& config) {
  CameraMount camera{.name = config.text("name"), .mount = mount(config), .lens = Lens::from(config)};
  camera.width = camera.lens.width;
  camera.height = camera.lens.height;
  camera.focal = camera.lens.focal();
  return camera;
}

void add_singles(const Config& config, const char* key, SingleInertialMount::Measures measures,
                 std::vector<SingleInertialMount>& singles) {
  if (!config.has(key)) return;
  for (const Config& one : config.list(key)) {
    SingleInertialMount single{.measures = measures, .signal = one.text("signal"), .axis_B = axis(one, "axis")};
    if (measures == SingleInertialMount::Measures::kForce) single.p_BS = bounded::vector3(one, "position", "m");
    if (std::ranges::find(singles, single.signal, &SingleInertialMount::signal) != singles.end())
      one.fail("signal", "two instruments are told as '" + single.signal + "'");
    if (singles.size() == kMostSingles)  // each has a bias in the Kalman filter's state
      one.fail("signal", "there are more than " + std::to_string(kMostSingles) +
                             " accelerometers and gyros beside the inertial package; leave some out");
    singles.push_back(std::move(single));
  }
}

}  // namespace

Mounts Mounts::from(const Config& config) {
  Mounts mounts;
  const auto simple = [&](const char* key, std::optional<Mount>& to) {
    if (config.has(key)) to = mount(config.section(key));
  };
  simple("ahrs", mounts.ahrs);
  simple("usbl", mounts.usbl);
  simple("depth", mounts.depth);
  simple("ranges", mounts.ranges);
  if (config.has("dvl")) {
    const Config dvl = config.section("dvl");
    mounts.dvl = DvlMount{.mount = mount(dvl), .beam_angle = bounded::positive(dvl, "beam_angle", "rad")};
    if (mounts.dvl->beam_angle >= 0.5 * std::numbers::pi) {
      dvl.fail("beam_angle", "'beam_angle' is counted from the instrument's down axis and stays below 90 deg");
    }
  }
  if (config.has("cameras")) {
    for (const Config& one : config.list("cameras")) {
      CameraMount camera = camera_mount(one);
      if (mounts.camera(camera.name) != nullptr) one.fail("name", "two cameras are called '" + camera.name + "'");
      mounts.cameras.push_back(std::move(camera));
    }
  }
  if (config.has("laser")) {
    const Config laser = config.section("laser");
    mounts.laser = LaserMount{
        .camera = laser.text("camera"), .p_CE = bounded::vector3(laser, "emitter", "m"), .axis_C = axis(laser, "axis")};
    if (mounts.camera(mounts.laser->camera) == nullptr) {
      laser.fail("camera", "no camera is called '" + mounts.laser->camera + "'");
    }
  }
  if (config.has("loads")) {
    for (const Config& one : config.list("loads")) {
      mounts.loads.push_back({.name = one.text("name"), .axis_B = axis(one, "axis"), .of = one.text("of")});
    }
  }
  add_singles(config, "accelerometers", SingleInertialMount::Measures::kForce, mounts.singles);
  add_singles(config, "gyros", SingleInertialMount::Measures::kRate, mounts.singles);
  return mounts;
}

const CameraMount* Mounts::camera(const std::string& name) const {
  const auto found = std::find_if(cameras.begin(), cameras.end(), [&](const auto& each) { return each.name == name; });
  return found == cameras.end() ? nullptr : &*found;
}

}  // namespace fathom::model
