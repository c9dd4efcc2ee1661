// Every instrument's derivatives against differences of its innovation.
#include "common/joint/joint_rows.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "common/base/spatial.hpp"
#include "test/common/joint/joint_vehicle.hpp"

using namespace fathom;
using namespace fathom::joint;

namespace {

const Eigen::Matrix3d kTold = rotation_from_euler({0.15, -0.1, 0.7}),
                      kCarried = rotation_from_euler({0.16, -0.08, 0.7});

JointVector somewhere(const JointFilter& filter) {
  JointVector x = filter.state();
  x.segment<3>(part::kAttitude).setZero();  // where derivatives are taken: a few milliradians make no difference
  x.segment<3>(part::kBias) << 0.02, -0.03, 0.01;
  x(part::kScale) = 3e-3;
  x(part::kHeight) = 4e-3;
  x.segment<3>(part::kOffset) << 1e-3, -2e-3, 1e-3;
  x.segment<3>(part::kTurned) << 4e-3, -3e-3, 5e-3;
  return x;
}

/// h is minus the derivative of the innovation.
void check(const JointVector& x, const std::function<JointRow(const JointVector&)>& row) {
  const JointRow here = row(x);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    CAPTURE(i);
    const double step = 1e-6 * (1.0 + std::abs(x(i)));
    JointVector above = x, below = x;
    above(i) += step;
    below(i) -= step;
    const double difference = (row(above).innovation - row(below).innovation) / (2.0 * step);
    CHECK(here.h(i) == doctest::Approx(-difference).epsilon(1e-6));
  }
}

}  // namespace

TEST_CASE("joint rows: derivatives of all instruments are those of differences") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("bluerov2");
  const JointFilter filter = example::filter(vehicle);
  const JointVector x = somewhere(filter);
  const Eigen::Vector3d arm{0.2, -0.1, 0.6};
  const estimation::CameraMount camera{.p_BC = {0.1, 0.02, 0.12}, .R_BC = rotation_from_euler({0.1, -0.05, 1.5707963})};
  constexpr double kFloor = 1.5;
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(i);
    check(x, [&](const JointVector& at) {
      std::array<JointRow, 3> rows;
      see_point(at, kTold, {0.5, 0.1, 1.5}, arm, rows);
      return rows[i];
    });
    check(x, [&](const JointVector& at) {
      std::array<JointRow, 3> rows;
      see_rates(at, {0.1, 0.2, -0.3}, rows);
      return rows[i];
    });
    check(x, [&](const JointVector& at) {
      std::array<JointRow, 3> rows;
      see_velocity(at, {0.3, 0.1, -0.1}, rows);
      return rows[i];
    });
    check(x, [&](const JointVector& at) {
      std::array<JointRow, 3> rows;
      const Vector6d tau = (Vector6d{} << 8.0, -5.0, 3.0, 0.2, 0.1, 0.7).finished();
      const Eigen::Vector3d w_dot{0.1, 0.2, 0.0}, p_BI{0.03, 0.01, -0.02};
      const Felt felt{.told = kTold, .carried = kCarried, .tau = tau, .w_dot = w_dot, .p_BI = p_BI, .gravity = 9.81};
      CHECK(feel_force(filter.model(), at, felt, {0.1, 0.2, -9.7}, rows) == 3);
      return rows[i];
    });
  }
  check(x, [&](const JointVector& at) {
    JointRow row;
    see_floor(at, kTold, kFloor, arm, row);
    return row;
  });
  for (std::size_t i = 0; i < 3; ++i) {
    check(x, [&](const JointVector& at) {
      std::array<JointRow, 3> rows;
      see_flow(at, kTold, kFloor, camera, {0.4, -0.3, 0.2}, rows);
      return rows[i];
    });
  }
  check(x, [&](const JointVector& at) {
    JointRow row;
    see_state(at, part::kPosition + 2, 0.7, row);
    return row;
  });
}

TEST_CASE("joint rows: what the vehicle would tell of itself leaves no innovation") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  const JointFilter filter = example::filter(vehicle);
  const JointVector& x = filter.state();  // no errors of instruments
  const Eigen::Vector3d p = x.head<3>(), v = x.segment<3>(part::kNu), w = x.segment<3>(part::kNu + 3);
  const estimation::CameraMount camera{.p_BC = {0.1, 0.0, 0.12}, .R_BC = rotation_from_euler({0.0, 0.0, 1.5707963})};
  std::array<JointRow, 3> rows;
  const Eigen::Vector3d p_WT{0.5, 0.1, 1.5};
  see_point(x, kTold, p_WT, kTold.transpose() * (p_WT - p), rows);
  for (const JointRow& row : rows) CHECK(std::abs(row.innovation) < 1e-12);
  const double d = distance(x, kTold, 1.5, camera);
  const Eigen::Vector3d floor_point = camera.p_BC + d * camera.R_BC.col(2);
  CHECK((p + kTold * floor_point).z() == doctest::Approx(1.5));
  see_floor(x, kTold, 1.5, floor_point, rows[0]);
  CHECK(std::abs(rows[0].innovation) < 1e-12);
  const Eigen::Vector3d v_C = estimation::velocity_of_camera(v, w, camera);
  see_flow(x, kTold, 1.5, camera, -v_C / d, rows);
  for (const JointRow& row : rows) CHECK(std::abs(row.innovation) < 1e-12);
}

// A scene that turns with w flows by (-w_y, w_x) in the middle of the picture; whoever takes that out with gyros takes
// out what they tell.
TEST_CASE("joint rows: gyros whose axes are turned tell of it, and so does the flow that they have corrected") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  const JointFilter filter = example::filter(vehicle);
  JointVector x = filter.state();
  x.segment<3>(part::kTurned) << 4e-3, -3e-3, 5e-3;
  const Eigen::Vector3d v = x.segment<3>(part::kNu), w = x.segment<3>(part::kNu + 3);
  const Eigen::Vector3d told = w + Eigen::Vector3d{x.segment<3>(part::kTurned)}.cross(w);
  std::array<JointRow, 3> rows;
  see_rates(x, told, rows);
  for (const JointRow& row : rows) CHECK(std::abs(row.innovation) < 1e-12);
  const estimation::CameraMount camera{.p_BC = {0.1, 0.0, 0.12}, .R_BC = rotation_from_euler({0.0, 0.0, 1.5707963})};
  const double d = distance(x, kTold, 1.5, camera);
  const Eigen::Vector3d v_C = estimation::velocity_of_camera(v, w, camera);
  const Eigen::Vector3d w_C = camera.R_BC.transpose() * w, told_C = camera.R_BC.transpose() * told;
  const auto of_turning = [](const Eigen::Vector3d& rate) { return Eigen::Vector3d{-rate.y(), rate.x(), 0.0}; };
  const Eigen::Vector3d flow = -v_C / d + of_turning(w_C) - of_turning(told_C);
  see_flow(x, kTold, 1.5, camera, flow, rows);
  for (const JointRow& row : rows) CHECK(std::abs(row.innovation) < 1e-12);
}

TEST_CASE("joint rows: the noise of a tilt is in the gravity it turns, and in no column of a parameter") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("bluerov2");
  const JointFilter filter = example::filter(vehicle);
  const JointVector x = somewhere(filter);
  const Vector6d tau = (Vector6d{} << 8.0, -5.0, 3.0, 0.2, 0.1, 0.7).finished();
  const Eigen::Vector3d w_dot{0.1, 0.2, 0.0}, p_BI{0.03, 0.01, -0.02};
  const auto rows_of = [&](const Eigen::Matrix3d& told) {
    std::array<JointRow, 3> rows;
    feel_force(filter.model(), x,
               {.told = told, .carried = kCarried, .tau = tau, .w_dot = w_dot, .p_BI = p_BI, .gravity = 9.81},
               {0.1, 0.2, -9.7}, rows);
    return rows;
  };
  constexpr double kTilt = 2e-3;
  const auto one = rows_of(kTold), other = rows_of(kTold * rotation_from_euler({0.0, kTilt, 0.0}));
  CHECK(std::abs(one[0].innovation - other[0].innovation) == doctest::Approx(9.81 * kTilt).epsilon(0.03));
  const Eigen::Index n = filter.model().size();
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK((one[i].h.tail(n) - other[i].h.tail(n)).cwiseAbs().maxCoeff() < 1e-12);
  }
}
