// Wrench to thrusters: by hand, at the limits, and for geometries that lack an axis.
#include "common/model/thruster_allocation.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using namespace fathom::model;

namespace {

constexpr double kCurve = 1e-9;  // the curve is piecewise linear in both directions
constexpr double kExact = 1e-12;

Vehicle vehicle(const std::string& name) {
  return Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/" + name + ".yaml");
}

}  // namespace

TEST_CASE("allocation: every controlled degree of freedom gets what was asked, alone and together") {
  for (const char* name : {"bluerov2", "beluga"}) {
    const Vehicle subject = vehicle(name);
    const ThrusterAllocation allocation{subject, 100.0};
    Vector6d tau = Vector6d::Zero();
    for (std::size_t i = 0; i < 6; ++i) {
      if (!subject.dof[i]) continue;
      const double share = i < 3 ? 4.0 : 0.3;
      tau(static_cast<Eigen::Index>(i)) = share;
      const Allocated result = allocation.allocate(tau, subject.curve.voltage);
      CAPTURE(name);
      CAPTURE(i);
      CHECK(result.scale == 1.0);
      for (std::size_t k = 0; k < 6; ++k) {
        if (!subject.dof[k]) continue;
        CHECK(std::abs(result.tau(static_cast<Eigen::Index>(k)) - tau(static_cast<Eigen::Index>(k))) < 1e-6);
      }
    }
  }
}

TEST_CASE("allocation: surge of the BlueROV2 by hand") {
  const ThrusterAllocation allocation{vehicle("bluerov2"), 100.0};
  Vector6d tau = Vector6d::Zero();
  tau(0) = 4.0 * 0.7071 * 8.1;  // four thrusters at 45 degrees; 8.1 N is a corner of the curve, at 1600 us
  const Allocated result = allocation.allocate(tau, 16.0);
  for (std::size_t i = 0; i < 4; ++i) CHECK(result.pwm_us[i] == doctest::Approx(1600.0).epsilon(1e-3));
  for (std::size_t i = 4; i < 6; ++i)
    CHECK(result.pwm_us[i] == 1500.0);  // no force is neutral, not an edge of the plateau
}

TEST_CASE("allocation: beyond the limit all thrusters shrink alike and the direction stays") {
  const ThrusterAllocation allocation{vehicle("bluerov2"), 5.0};
  Vector6d tau = Vector6d::Zero();
  tau(0) = 100.0;
  tau(5) = 5.0;
  const Allocated result = allocation.allocate(tau, 16.0);
  CHECK(result.scale < 0.3);
  for (const Eigen::Index axis : {0, 1, 2, 3, 5}) {  // pitch is not controlled
    CHECK(std::abs(result.tau(axis) - result.scale * tau(axis)) < 1e-6);
  }
  for (const double force : result.force) CHECK(std::abs(force) <= 5.0 + kCurve);
}

TEST_CASE("allocation: what the vehicle reports gives the wrench that it felt") {
  const ThrusterAllocation allocation{vehicle("bluerov2"), 100.0};
  Vector6d tau = Vector6d::Zero();
  tau << 5.0, -3.0, 4.0, 0.1, 0.0, 0.5;
  const Allocated sent = allocation.allocate(tau, 16.0);
  const Allocated told = allocation.applied(sent.pwm_us, 16.0);
  CHECK((told.tau - sent.tau).norm() < kCurve);
  CHECK(allocation.neutral().tau.norm() == 0.0);
  Vehicle bare = vehicle("bluerov2");
  bare.thrusters.clear();
  CHECK(test::complaint_of<InputError>([&] { ThrusterAllocation none(bare, 1.0); }).find("thrusters") !=
        std::string::npos);
}

TEST_CASE("allocation: the LBV150 without a thrust curve, by hand: yaw by the pair, sway by three") {
  const ThrusterAllocation allocation{vehicle("seabotix_lbv150"), 13.0};
  Vector6d tau = Vector6d::Zero();
  tau(5) = 0.95;  // N m = 0.0475 m (port - starboard): 10 N against -10 N
  const Allocated yaw = allocation.allocate(tau, 0.0);
  CHECK(yaw.pwm_us.empty());
  CHECK(std::abs(yaw.force[0] - 10.0) < kExact);
  CHECK(std::abs(yaw.force[1] + 10.0) < kExact);
  CHECK(std::abs(yaw.force[3]) < kExact);
  tau.setZero();
  tau(1) = 10.0;  // the lateral thruster 5 cm ahead of the origin turns it: the pair holds against 0.5 N m
  const Allocated sway = allocation.allocate(tau, 0.0);
  CHECK(std::abs(sway.force[3] - 10.0) < kExact);
  CHECK(std::abs(sway.force[0] + 0.5 / 0.095) < 1e-9);
  CHECK(std::abs(sway.force[1] - 0.5 / 0.095) < 1e-9);
  CHECK((sway.tau - tau).norm() < kExact);
}

TEST_CASE("allocation: beyond the LBV150's limit the direction stays") {
  const ThrusterAllocation allocation{vehicle("seabotix_lbv150"), 13.0};
  Vector6d tau = Vector6d::Zero();
  tau << 20.0, 5.0, 3.0, 0.0, 0.0, 1.0;
  const Allocated result = allocation.allocate(tau, 0.0);
  CHECK(result.scale < 1.0);
  CHECK((result.tau - result.scale * tau).norm() < 1e-9);
  double largest = 0.0;
  for (const double force : result.force) largest = std::max(largest, std::abs(force));
  CHECK(std::abs(largest - 13.0) < kExact);
}

TEST_CASE("allocation: an axis that the geometry lacks is named in one line and the rest is given") {
  const ThrusterAllocation allocation{vehicle("bluerov2"), 100.0};
  Vector6d tau = Vector6d::Zero();
  tau(0) = 5.0;
  tau(4) = 1.0;
  const Allocated result = allocation.allocate(tau, 16.0);
  CHECK(result.missing[4]);
  CHECK(result.tau(0) == doctest::Approx(5.0));
  const std::string line = allocation.complaint(result);
  CHECK(line.find("commanded pitch, which the thrusters of BlueROV2 cannot produce") != std::string::npos);
  CHECK(line.find('\n') == std::string::npos);
  tau(4) = 0.0;
  CHECK(allocation.complaint(allocation.allocate(tau, 16.0)).empty());
}

TEST_CASE("allocation: a free motion that no thruster drives is left alone, and named when it is commanded") {
  Vehicle subject = vehicle("seabotix_lbv150");
  subject.allocation.row(5).setZero();  // both in line with the origin, and the lateral one as well
  const ThrusterAllocation allocation{subject, 13.0};
  Vector6d tau = Vector6d::Zero();
  tau(0) = 5.0;
  CHECK(allocation.complaint(allocation.allocate(tau, 0.0)).empty());
  CHECK(allocation.allocate(tau, 0.0).tau(0) == doctest::Approx(5.0));
  tau(5) = 1.0;
  CHECK(allocation.complaint(allocation.allocate(tau, 0.0)).find("commanded yaw") != std::string::npos);
  subject.allocation.setZero();
  const std::string line = test::complaint_of<InputError>([&] { ThrusterAllocation none(subject, 13.0); });
  CHECK(line.find("produce none of the motions in 'dof'") != std::string::npos);
}

TEST_CASE("allocation: arms that no shipyard means are refused, short ones are not") {
  for (const double arm : {1e-4, 5e-4, 0.02}) {  // m
    CAPTURE(arm);
    Vehicle subject = vehicle("seabotix_lbv150");
    for (Eigen::Index i = 0; i < subject.allocation.cols(); ++i) {
      double& yaw = subject.allocation(5, i);
      if (yaw != 0.0) yaw = std::copysign(arm, yaw);
    }
    const std::string line = test::complaint_of<InputError>([&] { ThrusterAllocation one(subject, 13.0); });
    CHECK((line.find("hardly produce yaw") != std::string::npos) == (arm < 0.001));
    CHECK(line.find('\n') == std::string::npos);
  }
}
