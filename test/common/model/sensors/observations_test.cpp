// Observations by hand, and their rows against differences.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/model/sensors/accelerometer.hpp"
#include "common/model/sensors/attitude.hpp"
#include "common/model/sensors/gyro.hpp"
#include "common/model/sensors/heading.hpp"
#include "common/model/sensors/level_floor.hpp"
#include "common/model/sensors/position.hpp"
#include "common/model/sensors/pressure.hpp"
#include "common/model/sensors/range.hpp"
#include "common/model/sensors/tag_pose.hpp"
#include "common/model/sensors/velocity_log.hpp"

namespace fathom::model {
namespace {

constexpr double kExact = 1e-12;      // rounding of a few products
constexpr double kDifference = 1e-5;  // central differences of 1e-6 of smooth functions
constexpr double kSmallTurn = 2e-3;   // a rotation vector's derivative away from zero innovation is its first term

KinematicVector some_state() {
  KinematicVector x;
  x.head<kLoggedStates>() << 3.0, 10.0, 2.0, 0.4, -0.2, 0.05, 0.1, -0.2, 1.3, 0.05, 0.1, -0.04, 0.1, -0.2, 0.3, 0.4,
      0.5, -0.6, 0.02, -0.01, 0.03, 0.001, 0.002, -0.003, 0.004, -0.005, 0.006;
  x.tail<kMostSingles>() << 0.01, -0.02, 0.03, -0.04, 0.05, -0.06, 0.001, -0.002, 0.003;
  return x;
}

using Look = std::function<Observation(const KinematicPoint&)>;

using Reference = std::optional<Eigen::Matrix3d>;

void check_row(const std::string& name, const Reference& reference, const Look& look, double tolerance = kDifference) {
  CAPTURE(name);
  const KinematicVector x = some_state();
  const Observation here = look(KinematicPoint{x, reference});
  for (int i = 0; i < kMostStates; ++i) {
    constexpr double kStep = 1e-6;
    KinematicVector above = x, below = x;
    above[i] += kStep;
    below[i] -= kStep;
    const double slope =
        -(look(KinematicPoint{above, reference}).innovation - look(KinematicPoint{below, reference}).innovation) /
        (2.0 * kStep);
    CAPTURE(i);
    CHECK(here.row[i] == doctest::Approx(slope).epsilon(tolerance).scale(1.0));
    if ((here.groups >> static_cast<unsigned>(i / 3) & 1U) == 0) CHECK(here.row[i] == 0.0);
  }
}

}  // namespace

TEST_CASE("accelerometer: at rest and level the one along z says -g, and bias adds") {
  KinematicVector x = KinematicVector::Zero();
  x[at::kBias + 2] = 0.3;
  const Observation seen =
      observe(KinematicPoint{x}, Accelerometer{{0.3, 0.1, 0.2}, {0.0, 0.0, 1.0}, 2}, -kGravity, 1.0);
  CHECK(seen.innovation == doctest::Approx(-0.3).epsilon(kExact));
  const Accelerometer elsewhere{.direction_B = {0.0, 0.0, 1.0}, .gravity = 9.78};  // at rest on the equator
  CHECK(observe(KinematicPoint{KinematicVector::Zero()}, elsewhere, -9.78, 1.0).innovation == doctest::Approx(0.0));
}

TEST_CASE("accelerometer: bow down by 0.2 rad it feels gravity forward as Pereira and Duncan's eq. 12 says") {
  KinematicVector x = KinematicVector::Zero();
  x[at::kAngles + 1] = -0.2;
  // g = (-g sin(theta), ...) and a = ... - g: along x the instrument says + g sin(theta).
  const double said = kGravity * std::sin(-0.2);
  CHECK(observe(KinematicPoint{x}, Accelerometer{}, said, 1.0).innovation ==
        doctest::Approx(0.0).epsilon(kExact).scale(1.0));
}

TEST_CASE("accelerometer: off the axis of a steady turn it feels the centripetal acceleration and nothing else") {
  KinematicVector x = KinematicVector::Zero();
  x[at::kRates + 2] = 2.0;
  const Accelerometer along{{0.5, 0.0, 0.0}, Eigen::Vector3d::UnitX(), -1};
  CHECK(observe(KinematicPoint{x}, along, -2.0, 1.0).innovation == doctest::Approx(0.0).epsilon(kExact).scale(1.0));
  const Accelerometer across{{0.5, 0.0, 0.0}, Eigen::Vector3d::UnitY(), -1};
  CHECK(observe(KinematicPoint{x}, across, 0.0, 1.0).innovation == doctest::Approx(0.0).epsilon(kExact).scale(1.0));
  x[at::kRateSlopes + 2] = 3.0;
  CHECK(observe(KinematicPoint{x}, across, 1.5, 1.0).innovation == doctest::Approx(0.0).epsilon(kExact).scale(1.0));
}

TEST_CASE("heading: declination is added to what the compass says, and the innovation goes the short way round") {
  KinematicVector x = KinematicVector::Zero();
  x[at::kAngles + 2] = 3.1;
  CHECK(observe_heading(KinematicPoint{x}, 0.05, -3.1, 1.0).innovation ==
        doctest::Approx(2.0 * std::acos(-1.0) - 6.2 + 0.05).epsilon(1e-9));
}

TEST_CASE("depth: a port before the origin goes down when the bow does") {
  KinematicVector x = KinematicVector::Zero();
  x[2] = 5.0;
  x[at::kAngles + 1] = -0.3;
  const Observation seen = observe_depth(KinematicPoint{x}, {1.0, 0.0, 0.0}, 5.0 + std::sin(0.3), 1.0);
  CHECK(seen.innovation == doctest::Approx(0.0).epsilon(kExact).scale(1.0));
}

TEST_CASE("range: three, four, five, and no direction on top of the transponder") {
  KinematicVector x = KinematicVector::Zero();
  const Observation seen = observe_range(KinematicPoint{x}, {0.0, 0.0, 0.0}, {3.0, 4.0, 0.0}, 5.5, 1.0);
  CHECK(seen.innovation == doctest::Approx(0.5).epsilon(kExact));
  CHECK(seen.row[0] == doctest::Approx(-0.6).epsilon(kExact));
  CHECK(observe_range(KinematicPoint{x}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 1.0).row.isZero(0.0));
}

TEST_CASE("velocity log: heading east at 1 m/s over ground it says 1 m/s ahead") {
  KinematicVector x = KinematicVector::Zero();
  x[at::kVelocity + 1] = 1.0;
  x[at::kAngles + 2] = 0.5 * std::acos(-1.0);
  for (const auto& one : observe_velocity(KinematicPoint{x}, {0, 0, 0}, {1.0, 0.0, 0.0}, 1.0)) {
    CHECK(one.innovation == doctest::Approx(0.0).epsilon(kExact).scale(1.0));
  }
}

TEST_CASE("tag: a pose in the camera becomes the pose of the hull, whatever the mounting") {
  const Pose X_WT{{4.0, 1.0, 3.0}, quaternion_from_rotation_vector({0.1, -2.0, 0.3})};
  const Pose X_BC{{0.3, 0.05, 0.1}, quaternion_from_rotation_vector({0.5, 1.0, -0.2})};
  const Pose X_WB{{1.0, 2.0, 1.5}, quaternion_from_rotation_vector({-0.1, 0.2, 0.9})};
  const Eigen::Quaterniond q_WC = X_WB.q * X_BC.q;
  const Eigen::Vector3d p_WC = X_WB.p + X_WB.q * X_BC.p;
  const Pose X_CT{q_WC.conjugate() * (X_WT.p - p_WC), q_WC.conjugate() * X_WT.q};
  const Pose back = body_from_tag(X_WT, X_CT, X_BC);
  CHECK((back.p - X_WB.p).norm() < kExact * 10.0);
  CHECK(back.q.angularDistance(X_WB.q) < 1e-7);  // an arc cosine near one
}

TEST_CASE(
    "floor: a level camera 0.5 m above it at 0.2 m/s ahead sees the scene go back and grow as it sinks, and a dot at "
    "0.5 m") {
  KinematicVector x = KinematicVector::Zero();
  x[2] = 1.0;
  x[at::kVelocity] = 0.2;
  x[at::kVelocity + 2] = 0.3;  // down
  // The camera's x axis points to starboard, its y axis aft: read with the bow upward.
  const Pose X_BC{{0.0, 0.0, 0.1}, Eigen::Quaterniond{Eigen::AngleAxisd{std::acos(0.0), Eigen::Vector3d::UnitZ()}}};
  const KinematicPoint level{x};
  CHECK(distance_to_floor(level, 1.6, X_BC, Eigen::Vector3d::UnitZ()).value() == doctest::Approx(0.5).epsilon(kExact));
  const auto flow = observe_flow(level, 1.6, X_BC, {0.0, 0.4, -0.6}, {1.0, 1.0, 1.0});  // v_C = (0, -0.2, 0.3)
  REQUIRE(flow);
  for (const auto& one : *flow) CHECK(one.innovation == doctest::Approx(0.0).epsilon(kExact).scale(1.0));
  const auto dot = observe_floor_point(level, 1.6, X_BC, {0.0, 0.0, 0.53}, 1.0);
  REQUIRE(dot);
  CHECK(dot->innovation == doctest::Approx(0.03).epsilon(1e-9));
  x[at::kAngles] = 3.0;  // bottom up: there is no floor in sight
  CHECK_FALSE(observe_flow(KinematicPoint{x}, 1.6, X_BC, {0.0, 0.4, -0.6}, {1.0, 1.0, 1.0}));
  CHECK_FALSE(observe_floor_point(KinematicPoint{x}, 1.6, X_BC, {0.0, 0.0, 0.53}, 1.0));
}

namespace {

void check_all(const Reference& reference, bool over_a_floor) {
  const Eigen::Vector3d arm{0.3, -0.1, 0.2}, d = Eigen::Vector3d(0.6, 0.64, 0.48);
  check_row("accelerometer", reference, [&](const auto& p) { return observe(p, Accelerometer{arm, d, 1}, 0.3, 1.0); });
  check_row("gyro", reference, [&](const auto& p) { return observe(p, Gyro{d, 4}, 0.1, 1.0); });
  constexpr int kSingle = at::kSingleBias - at::kBias + 5;
  check_row("accelerometer beside the package", reference, [&](const auto& p) {
    return observe(p, Accelerometer{arm, d, kSingle}, 0.3, 1.0);
  });
  check_row("heading", reference, [&](const auto& p) { return observe_heading(p, 0.02, 1.25, 1.0); });
  check_row("depth", reference, [&](const auto& p) { return observe_depth(p, arm, 2.2, 1.0); });
  check_row("range", reference, [&](const auto& p) { return observe_range(p, arm, {20.0, -5.0, 12.0}, 22.0, 1.0); });
  const KinematicPoint here{some_state(), reference};
  const Eigen::Quaterniond near = Eigen::Quaterniond{here.R_WB} * quaternion_from_rotation_vector({1e-3, -5e-4, 2e-4});
  const Pose X_WT{{4.0, 11.0, 3.0}, near * quaternion_from_rotation_vector({0.1, 1.0, 0.3})};
  const Pose X_BC{arm, quaternion_from_rotation_vector({0.5, 1.0, -0.2})};
  const Eigen::Quaterniond q_WC = near * X_BC.q;
  const Pose X_CT{q_WC.conjugate() * (X_WT.p - here.group(0) - near * X_BC.p), q_WC.conjugate() * X_WT.q};
  for (std::size_t i = 0; i < 3; ++i) {
    check_row("position", reference, [&](const auto& p) { return observe_position(p, arm, {3, 9, 2}, {1, 1, 1})[i]; });
    check_row("velocity", reference, [&](const auto& p) { return observe_velocity(p, arm, {0.3, 0.1, 0}, 1.0)[i]; });
    check_row("velocity with bias", reference, [&](const auto& p) {
      return observe_velocity(p, arm, {0.3, 0.1, 0}, 1.0, true)[i];
    });
    check_row(
        "attitude", reference, [&](const auto& p) { return observe_attitude(p, near, 1.0)[i]; }, kSmallTurn);
    check_row(
        "attitude by heading and tilt", reference,
        [&](const auto& p) { return observe_attitude(p, near, Eigen::Vector3d(1.0, 1.0, 4.0))[i]; }, kSmallTurn);
    check_row("tag", reference, [&](const auto& p) { return observe_tag(p, X_WT, X_BC, X_CT, 1.0, 1.0, 1.0)[i]; });
  }
  if (!over_a_floor) return;
  const Pose down{arm, quaternion_from_rotation_vector({0.1, -0.2, 1.4})};
  for (std::size_t i = 0; i < 3; ++i)
    check_row("flow", reference, [&](const auto& p) {
      return (*observe_flow(p, 3.5, down, {0.1, -0.2, 0.3}, {1, 1, 1}))[i];
    });
  check_row("floor point", reference, [&](const auto& p) {
    return *observe_floor_point(p, 3.5, down, {0.2, -0.1, 1.1}, 1.0);
  });
}

}  // namespace

TEST_CASE("observations: every row is the derivative of what is predicted, by roll, pitch, yaw and on rotations") {
  check_all(std::nullopt, true);
  const KinematicPoint here{some_state()};
  const Eigen::Vector3d angles = here.group(at::kAngles);
  const Eigen::Quaterniond back = quaternion_from_rotation_vector(-angles);
  check_all(here.R_WB * back, true);                               // the same attitude
  check_all(rotation_from_euler({0.4, 1.5, -2.0}) * back, false);  // on its bow: no angles of Euler's tell that
}

}  // namespace fathom::model
