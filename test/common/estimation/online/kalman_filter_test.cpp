// The filter and the smoother against textbook versions with full matrices, and over hours.
#include "common/estimation/online/kalman_filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>
#include <vector>

#include "common/estimation/smoothing/smoother.hpp"
#include "common/model/sensors/accelerometer.hpp"
#include "common/model/sensors/gyro.hpp"
#include "common/model/sensors/heading.hpp"
#include "common/model/sensors/pressure.hpp"
#include "common/model/sensors/range.hpp"
#include "common/model/sensors/velocity_log.hpp"

namespace fathom::estimation {
namespace {

namespace at = model::at;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr double kSame = 1e-8;   // two orders of the same sums, relative
constexpr double kSlope = 1e-6;  // differences of the motion model
constexpr double kNoGate = 1e9;

/// The motion model written out again: eqs. 6 to 11, and the coupling.
Vector moved(const Vector& x, double dt, KinematicModel model) {
  Vector y = x;
  const double phi = x[6], theta = x[7], psi = x[8];
  Eigen::Matrix3d C;
  C << 1, std::sin(phi) * std::tan(theta), std::cos(phi) * std::tan(theta), 0, std::cos(phi), -std::sin(phi), 0,
      std::sin(phi) / std::cos(theta), std::cos(phi) / std::cos(theta);
  const Eigen::Vector3d a_W = rotation_from_euler({phi, theta, psi}) * x.segment<3>(9);
  y.segment<3>(0) += dt * x.segment<3>(3);
  if (model == KinematicModel::kCoupled) {
    y.segment<3>(0) += 0.5 * dt * dt * a_W;
    y.segment<3>(3) += dt * a_W;
  }
  y.segment<3>(6) += C * (dt * x.segment<3>(12) + 0.5 * dt * dt * x.segment<3>(15));
  y.segment<3>(12) += dt * x.segment<3>(15);
  return y;
}

Matrix slope(const Vector& x, double dt, KinematicModel model) {
  Matrix F(x.size(), x.size());
  for (int i = 0; i < x.size(); ++i) {
    Vector above = x, below = x;
    above[i] += 1e-5;
    below[i] -= 1e-5;
    F.col(i) = (moved(above, dt, model) - moved(below, dt, model)) / 2e-5;
  }
  return F;
}

/// The integral of F G G' F' over the step, by Simpson's rule, with the attitude held.
Matrix noise_of(const Vector& x, double dt, const ProcessNoise& noise, KinematicModel model) {
  const auto n = x.size();
  const auto density = [&](double left) {
    Matrix G = Matrix::Zero(n, 12);
    const Eigen::Matrix3d R = rotation_from_euler(x.segment<3>(6));
    Matrix F = Matrix::Identity(n, n);
    Eigen::Matrix3d C;
    const double phi = x[6], theta = x[7];
    C << 1, std::sin(phi) * std::tan(theta), std::cos(phi) * std::tan(theta), 0, std::cos(phi), -std::sin(phi), 0,
        std::sin(phi) / std::cos(theta), std::cos(phi) / std::cos(theta);
    F.block<3, 3>(0, 3) = left * Eigen::Matrix3d::Identity();
    if (model == KinematicModel::kCoupled) {
      F.block<3, 3>(0, 9) = 0.5 * left * left * R;
      F.block<3, 3>(3, 9) = left * R;
    }
    F.block<3, 3>(6, 12) = left * C;
    F.block<3, 3>(6, 15) = 0.5 * left * left * C;
    F.block<3, 3>(12, 15) = left * Eigen::Matrix3d::Identity();
    G.block<3, 3>(9, 0) = noise.jerk * Eigen::Matrix3d::Identity();
    G.block<3, 3>(15, 3) = noise.angular_jerk * Eigen::Matrix3d::Identity();
    if (model == KinematicModel::kPrinted) G.block<3, 3>(3, 6) = noise.velocity * Eigen::Matrix3d::Identity();
    if (n > 18) {
      G.block<3, 3>(18, 9) = noise.accelerometer_bias * Eigen::Matrix3d::Identity();
      Matrix wider = Matrix::Zero(n, 15);
      wider.leftCols(12) = G;
      wider.block<3, 3>(21, 12) = noise.gyro_bias * Eigen::Matrix3d::Identity();
      G = wider;
    }
    if (n > 24) {
      Matrix wider = Matrix::Zero(n, 18);
      wider.leftCols(15) = G;
      wider.block<3, 3>(24, 15) = noise.log_bias * Eigen::Matrix3d::Identity();
      G = wider;
    }
    return Matrix(F * G * G.transpose() * F.transpose());
  };
  constexpr int kParts = 4;  // exact for the chains' polynomials but their highest power
  Matrix Q = Matrix::Zero(n, n);
  for (int i = 0; i < kParts; ++i) {
    const double h = dt / kParts, from = i * h;
    Q += h / 6.0 * (density(from) + 4.0 * density(from + 0.5 * h) + density(from + h));
  }
  return Q;
}

struct Dense {
  std::vector<Vector> x, predicted;
  std::vector<Matrix> P, P_predicted, F;
};

/// What an inertial package, a compass, a depth gauge and two transponders see of a random walk about a circle; `log`:
/// and a velocity log with a bias.
std::vector<model::Observation> look(const model::KinematicPoint& point, int k, std::mt19937& random,
                                     bool log = false) {
  std::normal_distribution<double> normal;
  std::vector<model::Observation> rows;
  const double yaw = 0.1 * 0.05 * k;
  for (int i = 0; i < 3; ++i) {
    const bool bias = true;
    const double g[3] = {0.0, 0.0, -model::kGravity};
    rows.push_back(observe(point, model::Accelerometer{{0.2, 0.1, 0.0}, Eigen::Vector3d::Unit(i), bias ? i : -1},
                           g[i] + 0.05 * normal(random), 0.0025));
    rows.push_back(observe(point, model::Gyro{Eigen::Vector3d::Unit(i), 3 + i},
                           (i == 2 ? 0.1 : 0.0) + 0.005 * normal(random), 2.5e-5));
  }
  rows.push_back(model::observe_heading(point, 0.0, yaw + 0.02 * normal(random), 4e-4));
  rows.push_back(model::observe_depth(point, {0, 0, 0}, 3.0 + 0.02 * normal(random), 4e-4));
  if (log && k % 3 == 0) {
    for (const auto& row : model::observe_velocity(point, {0, 0, 0}, {0.5, 0.01, -0.01}, 4e-4, true))
      rows.push_back(row);
  }
  if (k % 5 == 0) {
    const Eigen::Vector3d p{5.0 * std::sin(yaw), 5.0 - 5.0 * std::cos(yaw), 3.0};
    for (const Eigen::Vector3d& T :
         {Eigen::Vector3d(20, 0, 8), Eigen::Vector3d(0, 20, 8), Eigen::Vector3d(-9, -9, 8)}) {
      rows.push_back(model::observe_range(point, {0, 0, 0}, T, (p - T).norm() + 0.05 * normal(random), 2.5e-3));
    }
  }
  return rows;
}

template <int N>
void against_textbook(KinematicModel model) {
  const ProcessNoise noise{.jerk = 0.05, .angular_jerk = 0.08, .velocity = 0.1};
  using State = typename KalmanFilter<N>::State;
  State x0 = State::Zero(), sigma = State::Constant(0.3);
  x0[2] = 2.5;
  x0[7] = -0.2;
  x0[12] = 0.3;
  x0.template segment<3>(9) << 0.3, -0.2, 0.1;
  if constexpr (N > 18) sigma.template tail<N - 18>().setConstant(0.02);
  KalmanFilter<N> filter;
  filter.start(x0, sigma);
  FilterRecord<N> record;
  record.begin(filter);
  Dense dense;
  dense.x.push_back(x0);
  dense.P.emplace_back(Matrix(sigma.cwiseAbs2().asDiagonal()));
  std::mt19937 random{7};
  constexpr double dt = 0.05;
  constexpr int kSteps = 120;
  for (int k = 1; k <= kSteps; ++k) {
    dense.F.push_back(slope(dense.x.back(), dt, model));
    dense.predicted.push_back(moved(dense.x.back(), dt, model));
    dense.P_predicted.push_back(dense.F.back() * dense.P.back() * dense.F.back().transpose() +
                                noise_of(dense.x.back(), dt, noise, model));
    filter.predict(dt, noise, model);
    REQUIRE((filter.state() - dense.predicted.back()).norm() < kSame);
    const double difference = (filter.covariance() - dense.P_predicted.back()).norm() / dense.P_predicted.back().norm();
    REQUIRE(difference < kSlope);
    State moved_by = State::Zero();
    const auto rows = look(filter.point(), k, random, N > 24);
    Matrix H(rows.size(), N);
    Vector innovation(rows.size()), variance(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto r = static_cast<Eigen::Index>(i);
      H.row(r) = rows[i].row.template head<N>().transpose();
      innovation[r] = rows[i].innovation;
      variance[r] = rows[i].variance;
      record.add(rows[i], filter.update(rows[i], kNoGate, moved_by));
    }
    record.add(true, filter);
    const Matrix& P = dense.P_predicted.back();
    const Matrix S = H * P * H.transpose() + Matrix(variance.asDiagonal());
    const Matrix K = P * H.transpose() * S.inverse();
    dense.x.push_back(dense.predicted.back() + K * innovation);
    dense.P.push_back(P - K * S * K.transpose());
    REQUIRE((filter.state() - dense.x.back()).norm() < kSlope);
    REQUIRE((filter.covariance() - dense.P.back()).norm() < kSlope * dense.P.back().norm());
  }
  // Rauch, Tung and Striebel, word by word.
  std::vector<Vector> xs = dense.x;
  std::vector<Matrix> P_smoothed = dense.P;
  for (int k = kSteps - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    const Matrix C = dense.P[i] * dense.F[i].transpose() * dense.P_predicted[i].inverse();
    xs[i] = dense.x[i] + C * (xs[i + 1] - dense.predicted[i]);
    P_smoothed[i] = dense.P[i] + C * (P_smoothed[i + 1] - dense.P_predicted[i]) * C.transpose();
  }
  Smoother<N> smoother;
  int visited = 0;
  smoother.back_over(record, [&](std::size_t k, const Smoothed<N>& smoothed) {
    ++visited;
    CHECK((smoothed.state() - xs[k]).norm() < 20.0 * kSlope);
    CHECK((smoothed.covariance() - P_smoothed[k]).norm() < 100.0 * kSlope * P_smoothed[k].norm());
    CHECK((smoothed.variance() - smoothed.covariance().diagonal()).norm() < kSame);
  });
  CHECK(visited == kSteps);
}

}  // namespace

TEST_CASE("Kalman filter and smoother: the numbers of the textbook, printed and coupled, with and without biases") {
  against_textbook<24>(KinematicModel::kCoupled);
  against_textbook<24>(KinematicModel::kPrinted);
  against_textbook<27>(KinematicModel::kCoupled);  // a velocity log's bias as well
}

TEST_CASE("Kalman filter: an infinite variance changes nothing, an outlier is refused") {
  KalmanFilter<18> filter;
  filter.start(KalmanFilter<18>::State::Zero(), KalmanFilter<18>::State::Constant(0.1));
  KalmanFilter<18>::State moved_by = KalmanFilter<18>::State::Zero();
  const auto before = filter.covariance();
  auto row = model::observe_depth(filter.point(), {0, 0, 0}, 0.05, std::numeric_limits<double>::infinity());
  CHECK_FALSE(filter.update(row, 5.0, moved_by).used);
  row = model::observe_depth(filter.point(), {0, 0, 0}, 40.0, 0.01);
  CHECK_FALSE(filter.update(row, 5.0, moved_by).used);
  CHECK(filter.covariance() == before);
  CHECK(filter.state().isZero(0.0));
  row.innovation = 0.1;
  CHECK(filter.update(row, 5.0, moved_by).used);
  CHECK(filter.state()[2] == doctest::Approx(0.05));
}

TEST_CASE("Kalman filter and smoother: consistent over 50 seeds when the motion is the model's own") {
  constexpr int kSeeds = 50, kSteps = 300;
  constexpr double dt = 0.05;
  const ProcessNoise noise{.jerk = 0.02, .angular_jerk = 3e-4};  // pitch stays far from the vertical, where the angles
                                                                 // would be counted anew
  double filter_nees = 0.0, smoother_nees = 0.0, nis = 0.0, observations = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    KalmanFilter<24>::State start = KalmanFilter<24>::State::Zero(), sigma, truth;
    sigma << Eigen::VectorXd::Constant(3, 0.5), Eigen::VectorXd::Constant(3, 0.2), Eigen::VectorXd::Constant(3, 0.05),
        Eigen::VectorXd::Constant(6, 0.01), Eigen::VectorXd::Constant(3, 0.001), Eigen::VectorXd::Constant(3, 0.05),
        Eigen::VectorXd::Constant(3, 0.005);
    for (int i = 0; i < 24; ++i) truth[i] = start[i] + sigma[i] * normal(random);
    KalmanFilter<24> filter;
    filter.start(start, sigma);
    FilterRecord<24> record;
    record.begin(filter);
    std::vector<KalmanFilter<24>::State> truths{truth};
    for (int k = 1; k <= kSteps; ++k) {
      Vector x = moved(truth, dt, KinematicModel::kCoupled);
      const Matrix Q = noise_of(truth, dt, noise, KinematicModel::kCoupled);
      // Q's chains are nearly singular: a square root by eigenvalues.
      const Eigen::SelfAdjointEigenSolver<Matrix> parts{Q};
      Vector draw(24);
      for (int i = 0; i < 24; ++i) draw[i] = std::sqrt(std::max(parts.eigenvalues()[i], 0.0)) * normal(random);
      truth = x + parts.eigenvectors() * draw;
      truths.push_back(truth);
      filter.predict(dt, noise, KinematicModel::kCoupled);
      model::KinematicVector wide = model::KinematicVector::Zero();
      wide.head<24>() = truth;
      const model::KinematicPoint point = filter.point(), there{wide};
      KalmanFilter<24>::State moved_by = KalmanFilter<24>::State::Zero();
      const auto take = [&](model::Observation row, double said) {
        row.innovation = said + std::sqrt(row.variance) * normal(random);
        const auto outcome = filter.update(row, kNoGate, moved_by);
        nis += outcome.nis();
        observations += 1.0;
        record.add(row, outcome);
      };
      // What an instrument says is the innovation of a zero reading at the truth, turned round.
      const auto both = [&](const auto& look) { take(look(point), look(point).innovation - look(there).innovation); };
      for (int i = 0; i < 3; ++i) {
        const model::Accelerometer accelerometer{{0.2, 0.1, 0.0}, Eigen::Vector3d::Unit(i), i};
        const model::Gyro gyro{Eigen::Vector3d::Unit(i), 3 + i};
        both([&](const auto& p) { return observe(p, accelerometer, 0.0, 0.0025); });
        both([&](const auto& p) { return observe(p, gyro, 0.0, 2.5e-5); });
      }
      both([&](const auto& p) { return model::observe_heading(p, 0.0, 0.0, 4e-4); });
      both([&](const auto& p) { return model::observe_depth(p, {0, 0, 0}, 0.0, 4e-4); });
      for (const Eigen::Vector3d& T :
           {Eigen::Vector3d(20, 0, 8), Eigen::Vector3d(0, 20, 8), Eigen::Vector3d(-9, -9, 8)}) {
        if (k % 5 == 0) both([&](const auto& p) { return model::observe_range(p, {0, 0, 0}, T, 0.0, 2.5e-3); });
      }
      record.add(true, filter);
    }
    const KalmanFilter<24>::State e = filter.state() - truth;
    filter_nees += e.dot(filter.covariance().ldlt().solve(e)) / (24.0 * kSeeds);
    Smoother<24> smoother;
    smoother.back_over(record, [&](std::size_t k, const Smoothed<24>& smoothed) {
      if (k != kSteps / 2) return;
      const KalmanFilter<24>::State off = smoothed.state() - truths[k];
      smoother_nees += off.dot(smoothed.covariance().ldlt().solve(off)) / (24.0 * kSeeds);
    });
  }
  MESSAGE("NEES per state: filter " << filter_nees << ", smoother " << smoother_nees << "; NIS " << nis / observations);
  constexpr double kBand = 0.125;  // three deviations of a mean of 1200 squares
  CHECK(filter_nees == doctest::Approx(1.0).epsilon(kBand));
  CHECK(smoother_nees == doctest::Approx(1.0).epsilon(kBand));
  CHECK(nis / observations == doctest::Approx(1.0).epsilon(0.02));  // 130,000 of them
}

TEST_CASE("Kalman filter and smoother: covariances stay positive and symmetric over four hours") {
  constexpr double dt = 0.1;
  constexpr int kSteps = 4 * 36000;
  constexpr int kStretch = 1000;
  const ProcessNoise noise{.jerk = 0.02, .angular_jerk = 0.02, .accelerometer_bias = 0.0, .gyro_bias = 0.0};
  KalmanFilter<24> filter;
  KalmanFilter<24>::State x0 = KalmanFilter<24>::State::Zero(), sigma = KalmanFilter<24>::State::Constant(1.0);
  x0[2] = 3.0;
  sigma.head<3>().setConstant(1e4);  // ten kilometres, against ranges of a millimetre below
  filter.start(x0, sigma);
  std::mt19937 random{3};
  FilterRecord<24> record;
  double smallest = 1.0;
  const auto eigenvalue = [](const Eigen::Matrix<double, 24, 24>& P) {
    const Eigen::Matrix<double, 24, 1> scale = P.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix<double, 24, 24> correlation = scale.asDiagonal() * P * scale.asDiagonal();
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 24, 24>>{correlation}.eigenvalues().minCoeff();
  };
  for (int k = 1; k <= kSteps; ++k) {
    if (k % kStretch == 1) record.begin(filter);
    filter.predict(dt, noise, KinematicModel::kCoupled);
    KalmanFilter<24>::State moved_by = KalmanFilter<24>::State::Zero();
    for (auto& row : look(filter.point(), k % 628, random)) {  // the heading is told in turns of 2 pi
      if (k % 628 == 0) continue;
      if (row.variance == 2.5e-3) row.variance = 1e-6;
      record.add(row, filter.update(row, kNoGate, moved_by));
    }
    record.add(true, filter);
    if (k % 5000 == 0 || k < 20) smallest = std::min(smallest, eigenvalue(filter.covariance()));
    REQUIRE(filter.covariance().diagonal().minCoeff() > 0.0);
  }
  CHECK(smallest > 0.0);
  CHECK(filter.covariance() == filter.covariance().transpose());
  Smoother<24> smoother;
  smoother.back_over(record, [&](std::size_t, const Smoothed<24>& smoothed) {
    const auto P = smoothed.covariance();
    REQUIRE(P.diagonal().minCoeff() > 0.0);
    smallest = std::min(smallest, eigenvalue(P));
  });
  CHECK(smallest > 0.0);
  MESSAGE("smallest eigenvalue of any correlation matrix: " << smallest);
}

}  // namespace fathom::estimation
