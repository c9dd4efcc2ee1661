// The filter's attitude as an error state on rotations: against differences of the motion, and through loopings.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <random>

#include "common/estimation/online/kalman_filter.hpp"
#include "common/model/sensors/attitude.hpp"
#include "common/model/sensors/gyro.hpp"

namespace fathom::estimation {
namespace {

using Matrix = Eigen::MatrixXd;
using Filter = KalmanFilter<18>;
using State = Filter::State;

constexpr double kSame = 1e-8;   // rounding
constexpr double kSlope = 1e-6;  // differences of the motion model
constexpr double kNoGate = 1e9;

/// Where a state about R_WB stands after dt: the attitude by itself, the rest as numbers.
struct Stand {
  Eigen::Matrix3d R_WB;
  State x;
};

Stand gone_on(const Stand& from, double dt) {
  Stand to = from;
  const Eigen::Vector3d a_W = from.R_WB * from.x.segment<3>(9);
  to.x.segment<3>(0) += dt * from.x.segment<3>(3) + 0.5 * dt * dt * a_W;
  to.x.segment<3>(3) += dt * a_W;
  const Eigen::Vector3d turn = dt * from.x.segment<3>(12) + 0.5 * dt * dt * from.x.segment<3>(15);
  to.R_WB = from.R_WB * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  to.x.segment<3>(12) += dt * from.x.segment<3>(15);
  return to;
}

/// What has to be added to `from` to come to `to`, the attitude as a turn in B.
State apart(const Stand& from, const Stand& to) {
  State off = to.x - from.x;
  const Eigen::AngleAxisd turn{Eigen::Matrix3d{from.R_WB.transpose() * to.R_WB}};
  off.segment<3>(6) = turn.angle() * turn.axis();
  return off;
}

}  // namespace

TEST_CASE("error state: on rotations it goes on as differences of the motion do, on its bow as well") {
  const Eigen::Matrix3d R_WB = rotation_from_euler({0.3, 1.56, -1.0});
  State x = State::Zero(), sigma;
  x.segment<3>(3) << 0.4, -0.2, 0.1;
  x.segment<3>(9) << 0.3, -0.5, 0.2;
  x.segment<3>(12) << 0.8, -1.1, 0.6;
  x.segment<3>(15) << 0.5, 0.4, -0.3;
  for (int i = 0; i < 18; ++i) sigma[i] = 0.01 * (1.0 + 0.3 * i);
  Filter filter;
  filter.start(x, sigma, R_WB);
  // Something that correlates everything, and turns the attitude by an update.
  constexpr double dt = 0.1;
  filter.predict(dt, {}, KinematicModel::kCoupled);
  State moved_by = State::Zero();
  const Eigen::Quaterniond seen =
      Eigen::Quaterniond{filter.point().R_WB} * quaternion_from_rotation_vector({.05, -.04, .03});
  for (const auto& row : model::observe_attitude(filter.point(), seen, 1e-4)) filter.update(row, kNoGate, moved_by);
  const auto before = filter.covariance();
  const State at_first = filter.state();
  const Stand from{filter.point().R_WB, [&] {
                     State rest = at_first;
                     rest.segment<3>(6).setZero();
                     return rest;
                   }()};
  filter.predict(dt, {.jerk = 0.0, .angular_jerk = 0.0, .accelerometer_bias = 0.0, .gyro_bias = 0.0},
                 KinematicModel::kCoupled);
  const Stand to = gone_on(from, dt);
  CHECK((filter.point().R_WB - to.R_WB).norm() < kSame);
  Matrix F(18, 18);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 18; ++i) {
    // A change of the old error state, which updates have moved, is one of the attitude.
    const auto stand = [&](double step) {
      State off = at_first;
      off[i] += step;
      Stand one{*filter.reference(), off};
      const Eigen::Vector3d angles = at_first.segment<3>(6), moved_angles = off.segment<3>(6);
      one.R_WB = from.R_WB * quaternion_from_rotation_vector(angles).conjugate().toRotationMatrix() *
                 quaternion_from_rotation_vector(moved_angles).toRotationMatrix();
      one.x.segment<3>(6).setZero();
      return gone_on(one, dt);
    };
    F.col(i) = (apart(to, stand(kStep)) - apart(to, stand(-kStep))) / (2.0 * kStep);
  }
  const Matrix expected = F * before * F.transpose();
  CHECK((filter.covariance() - expected).norm() < kSlope * expected.norm());
}

TEST_CASE("error state: on rotations it follows a vehicle through loopings, and says how well") {
  constexpr double dt = 0.02;
  const Eigen::Vector3d w{0.2, 1.5, 0.3};
  std::mt19937 random{8};
  std::normal_distribution<double> normal;
  State sigma;
  sigma << State::Constant(0.1);
  Filter filter, by_angles;
  filter.start(State::Zero(), sigma, Eigen::Matrix3d::Identity());
  by_angles.start(State::Zero(), sigma);
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  double nees = 0.0, count = 0.0;
  bool kept = true, kept_by_angles = true;
  const auto see = [&](Filter& one, const Eigen::Vector3d& rates, const Eigen::Quaterniond* attitude) {
    State moved_by = State::Zero();
    const auto point = one.point();
    for (int i = 0; i < 3; ++i)
      one.update(observe(point, model::Gyro{Eigen::Vector3d::Unit(i)}, rates[i], 1e-4), kNoGate, moved_by);
    if (attitude == nullptr) return;
    for (const auto& row : model::observe_attitude(point, *attitude, 4e-4)) one.update(row, kNoGate, moved_by);
  };
  for (int k = 1; k <= 3000; ++k) {
    q = (q * quaternion_from_rotation_vector(dt * w)).normalized();
    const Eigen::Vector3d rates = w + 0.01 * Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    const Eigen::Quaterniond told =
        q * quaternion_from_rotation_vector(0.02 * Eigen::Vector3d::NullaryExpr([&] { return normal(random); }));
    for (Filter* one : {&filter, &by_angles}) {
      one->predict(dt, {.jerk = 0.01, .angular_jerk = 0.05}, KinematicModel::kCoupled);
      see(*one, rates, k % 25 == 0 ? &told : nullptr);
    }
    kept = kept && filter.tells_attitude();
    kept_by_angles = kept_by_angles && by_angles.tells_attitude();
    if (k % 50 != 0 || k < 500) continue;
    const Eigen::Vector3d off =
        rotation_vector_from_quaternion(Eigen::Quaterniond{filter.point().R_WB}.conjugate() * q);
    nees += off.dot(filter.covariance().block<3, 3>(6, 6).ldlt().solve(off)) / 3.0;
    count += 1.0;
  }
  CHECK(kept);
  CHECK_FALSE(kept_by_angles);                               // roll and yaw are nothing where the bow points up
  CHECK(nees / count == doctest::Approx(1.0).epsilon(0.5));  // some ten independent instants
}

}  // namespace fathom::estimation
