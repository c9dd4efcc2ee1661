// A printing error of Karras et al. in deep water: (1.36) has lost the R_IN of (1.29), which turns the attitude
// sensor's north, east, down into the axes I of the transceiver. Fathom keeps the world's axes north, east, down, and
// turns what the transceiver says as soon as it is read; then R_IN is one.
#include <doctest/doctest.h>

#include <algorithm>

#include "common/devices/positions.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom {

TEST_CASE("printed 1.36: without R_IN dead reckoning goes another way than the fixes of a turned transceiver") {
  using Eigen::Vector3d;
  const devices::Transceiver transceiver{.p_W = {5.0, -3.0, 1.0}, .heading = 0.7};
  const Eigen::Matrix3d R_IN = rotation_from_euler({0.0, 0.0, transceiver.heading}).transpose();
  const test::SyntheticMotion motion{3};
  const auto fix_I = [&](double t) { return Vector3d{R_IN * (motion.p_WB(t) - transceiver.p_W)}; };
  const auto fix_W = [&](double t) {
    const Vector3d p = fix_I(t);  // forward, starboard, down of the transceiver
    return devices::from_head_up(p.x(), p.y(), p.z(), transceiver);
  };
  CHECK((fix_W(0.0) - motion.p_WB(0.0)).norm() < 1e-9);
  Vector3d printed = fix_I(0.0), corrected = fix_I(0.0), here = fix_W(0.0);
  const double dt = 0.001;
  double apart = 0.0, along = 0.0, in_world = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const double t = (k + 0.5) * dt;
    const Vector3d step = dt * motion.R_WB(t) * motion.v_B(t);  // R_IMU v: the sensor's attitude is to north
    printed += step;
    corrected += R_IN * step;
    here += step;
    apart = std::max(apart, (printed - fix_I(t + 0.5 * dt)).norm());
    along = std::max(along, (corrected - fix_I(t + 0.5 * dt)).norm());
    in_world = std::max(in_world, (here - fix_W(t + 0.5 * dt)).norm());
  }
  CHECK(apart > 0.3);  // m: of twenty seconds about one place
  CHECK(along < 1e-6);
  CHECK(in_world < 1e-6);
}

}  // namespace fathom
