// The printing errors of Karras et al. in the lever arms of the instruments of deep water, each as an example: on a
// motion that is known at every instant the printed form, typed here, fails, and what the drivers publish passes.
// Numbers are the paper's equations; rotations between instrument and body are left out (R_DVL = R_RSP = 1).
#include <doctest/doctest.h>

#include <cmath>

#include "common/driver/lever_arm.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom::driver {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStep = 1e-5;   // s
constexpr double kSmall = 1e-6;  // m, m/s: what differences over kStep leave of an exact equation
constexpr double kWrong = 0.02;  // what no trial could overlook
constexpr double kMoment = 7.3;  // s, when everything moves and tilts
constexpr Utime kNow = 1'700'000'000'000'000;

test::SyntheticMotion motion() { return test::SyntheticMotion{3}; }

/// What an instrument at `p_BS` says, as its driver publishes it.
template <class Sample>
Sample published(const Vector3d& p_BS, Sample sample) {
  const auto m = motion();
  LeverArm arm{p_BS};
  arm.hear(Ahrs{.utime = kNow,
                .w_WB_B = m.w_B(kMoment),
                .q_WB = Eigen::Quaterniond{m.R_WB(kMoment)},
                .has_rates = true,
                .has_attitude = true});
  sample.utime = kNow;
  arm.remove(sample);
  return sample;
}

}  // namespace

TEST_CASE("printed 1.35: a velocity log's lever arm is turned by the rates, not taken from the velocity") {
  const auto m = motion();
  const Vector3d lever{0.3, 0.0, 0.1};
  const auto place = [&](double t) { return Vector3d{m.p_WB(t) + m.R_WB(t) * lever}; };
  const Vector3d moved = (place(kMoment + kStep) - place(kMoment - kStep)) / (2.0 * kStep);
  const Vector3d measured = m.R_WB(kMoment).transpose() * moved;
  CHECK((measured - lever - m.v_B(kMoment)).norm() > kWrong);
  const Dvl sample = published(lever, Dvl{.v_WB_B = measured});
  CHECK(sample.valid);
  CHECK((sample.v_WB_B - m.v_B(kMoment)).norm() < kSmall);
}

TEST_CASE("printed 1.33, 1.35: a pressure port tells its depth whatever the tilt, positive down") {
  const auto m = motion();
  const Vector3d lever{-0.2, 0.1, 0.15};
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d p = m.p_WB(kMoment) + Vector3d{0.0, 0.0, 2.0};
  const double pressure = (p + R * lever).z();           // metres of water above the port
  CHECK(std::abs(p.z() / R(2, 2) - pressure) > kWrong);  // 1.33: water does not know how the vehicle is tilted
  CHECK(std::abs(-R(2, 2) * pressure - p.z()) > 1.0);    // 1.35: this aiding drives z to -z
  CHECK(std::abs(published(lever, Depth{.z = pressure}).z - p.z()) < kSmall);
}

TEST_CASE("printed 1.32: the world is turned into the vehicle by the transpose") {
  const auto m = motion();
  const Vector3d lever{0.1, 0.0, -0.2};
  const Matrix3d R = m.R_WB(kMoment);
  const Vector3d p = m.p_WB(kMoment) + Vector3d{10.0, -5.0, 3.0};
  const Vector3d fix = p + R * lever;               // where the transceiver, in I, hears the responder
  const Vector3d seen = R.transpose() * fix;        // the same in the responder's axes, which (1.35) begins with
  CHECK((R * p + lever - seen).norm() > 1.0);       // 1.32
  CHECK((R * (seen - lever) - p).norm() < kSmall);  // 1.35 is right, if 1.32 has the transpose...
  const Usbl sample = published(lever, Usbl{.p_WB = fix});
  CHECK(sample.valid);
  CHECK((sample.p_WB - p).norm() < kSmall);  // ...and is what the driver does, with a fix along I
}

}  // namespace fathom::driver
