// The filter by itself: its transition against differences, its covariance against rounding, what is held, and over
// many seeds whether errors are as large as it says, in a simulation of its own.
#include "common/joint/joint_filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "common/base/spatial.hpp"
#include "common/joint/joint_rows.hpp"
#include "test/common/joint/joint_vehicle.hpp"

using namespace fathom;
using namespace fathom::joint;

namespace {

const Vector6d kTau = (Vector6d{} << 8.0, -5.0, 3.0, 0.2, 0.1, 0.7).finished();
const Eigen::Matrix3d kFrom = rotation_from_euler({0.15, -0.1, 0.7}), kTo = rotation_from_euler({0.16, -0.12, 0.71});
const Eigen::Matrix3d kMiddle = rotation_from_euler({0.155, -0.11, 0.705});

JointVector gone_on(JointFilter filter, const JointVector& by, double dt) {
  filter.shift(by);
  filter.predict(dt, kFrom, kMiddle, kTo, kTau);
  return filter.state();
}

bool positive(const JointFilter& filter) {
  const Eigen::MatrixXd P = filter.covariance();
  const Eigen::VectorXd scale = P.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * P * scale.asDiagonal();
  return P.isApprox(P.transpose(), 1e-12) &&
         Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>{scaled}.eigenvalues().minCoeff() > -1e-9;
}

}  // namespace

TEST_CASE("joint filter: a prediction moves the covariance by the derivatives of the same prediction") {
  for (const char* name : {"seabotix_lbv150", "bluerov2"}) {
    CAPTURE(name);
    const model::Vehicle vehicle = fathom::test::vehicle_from_repository(name);
    const JointNoise quiet{.acceleration = 1e-12, .turning = 1e-12, .bias_walk = 1e-12, .attitude_memory = 1e12};
    JointFilter filter = example::filter(vehicle, quiet);
    constexpr double kDt = 0.01;
    const Eigen::Index n = filter.size();
    Eigen::MatrixXd F(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double step = 1e-5 * (1e-2 + std::abs(filter.state()(i)));
      JointVector by = JointVector::Zero(n);
      by(i) = step;
      F.col(i) = (gone_on(filter, by, kDt) - gone_on(filter, -by, kDt)) / (2.0 * step);
    }
    const Eigen::MatrixXd before = filter.covariance();
    filter.predict(kDt, kFrom, kMiddle, kTo, kTau);
    Eigen::MatrixXd after = filter.covariance();
    Eigen::MatrixXd expected = F * before * F.transpose();
    for (int axis = 0; axis < 6; ++axis) {  // axes that only follow what is measured diffuse
      if (filter.model().moves(axis)) continue;
      after.row(part::kNu + axis).setZero();
      after.col(part::kNu + axis).setZero();
      expected.row(part::kNu + axis).setZero();
      expected.col(part::kNu + axis).setZero();
    }
    const Eigen::VectorXd scale = expected.diagonal().cwiseMax(1e-12).cwiseSqrt();
    CHECK(((after - expected).array() / (scale * scale.transpose()).array()).abs().maxCoeff() < 1e-4);
  }
}

TEST_CASE("joint filter: from priors of hundreds to noise of micrometres the covariance stays positive") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  JointFilter filter = example::filter(vehicle);
  filter.start({0.0, 0.0, 0.5}, Vector6d::Zero(), Vector6d::Constant(100.0), 100.0);
  CHECK(positive(filter));
  std::mt19937 engine{3};
  std::normal_distribution<double> normal;
  for (int step = 0; step < 300; ++step) {
    filter.predict(0.01, Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(), kTau);
    std::array<JointRow, 6> rows;
    for (int i = 0; i < 3; ++i) {
      see_state(filter.state(), part::kPosition + i, 1e-6 * normal(engine), rows[static_cast<std::size_t>(2 * i)]);
      see_state(filter.state(), part::kNu + 3 + i, 1e-6 * normal(engine), rows[static_cast<std::size_t>(2 * i + 1)]);
    }
    for (JointRow& row : rows) row.variance = 1e-12;
    filter.update(rows, 1e9);
    REQUIRE(filter.covariance().diagonal().minCoeff() >= 0.0);
  }
  CHECK(positive(filter));
}

TEST_CASE("joint filter: what is held stays put in SI, also beside an inertia that is learnt") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  JointFilter filter = example::filter(vehicle);
  const auto number = [&](const char* name) {
    return static_cast<int>(std::ranges::find(vehicle.parameters, name) - vehicle.parameters.begin());
  };
  const int m_X = number("m_X"), X_u = number("X_u"), Y_v = number("Y_v"), m_Y = number("m_Y");
  for (const int k : {X_u, Y_v, m_Y}) filter.hold(k, true);
  const ParameterVector before = filter.model().physical(filter.parameters());
  std::mt19937 engine{4};
  std::normal_distribution<double> normal;
  for (int step = 0; step < 200; ++step) {
    filter.predict(0.02, Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(), kTau);
    std::array<JointRow, 3> rows;
    see_velocity(filter.state(), {0.5 + 0.01 * normal(engine), -0.2, 0.1}, rows);
    for (JointRow& row : rows) row.variance = 1e-4;
    filter.update(rows, 1e9);
  }
  const ParameterVector after = filter.model().physical(filter.parameters());
  CHECK(std::abs(after(m_X) - before(m_X)) > 1e-2);  // learnt
  for (const int k : {X_u, Y_v, m_Y}) CHECK(after(k) == doctest::Approx(before(k)).epsilon(1e-9));
  CHECK(positive(filter));
  for (const int k : {X_u, Y_v, m_Y}) filter.hold(k, false);
}

TEST_CASE("joint filter: a measurement beyond the gate, or without a finite variance, changes nothing") {
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  JointFilter filter = example::filter(vehicle);
  const JointVector x = filter.state();
  const JointMatrix P = filter.covariance();
  for (const auto& [value, variance] : {std::pair{50.0, 1e-4}, {0.4, std::nan("")}, {std::nan(""), 1e-4}}) {
    std::array<JointRow, 1> row;
    see_state(filter.state(), part::kPosition, value, row[0]);
    row[0].variance = variance;
    CHECK(filter.update(row, 5.0) == 0);
    CHECK(filter.state() == x);
    CHECK(filter.covariance() == P);
  }
}

TEST_CASE("joint filter: over seeds, the parameters' errors are as large as their covariance says") {
  // The truth is moved by the same equations and by the noise that the filter is told of; velocities, rates and
  // specific force are measured with white noise.
  const model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  const Normalised model = example::moving(vehicle);
  const ParameterVector theta = example::numbers(vehicle), truth = example::normalised(model, theta);
  constexpr int kSeeds = 40;
  constexpr double kDt = 0.02, kDuration = 40.0, kVelocity = 0.01, kRate = 0.004, kForce = 0.05;
  const JointNoise noise{.acceleration = 5e-3, .turning = 2e-2, .bias_walk = 1e-6, .attitude = 1e-4};
  double nees = 0.0, largest = 0.0;
  int inside = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937 engine{seed};
    std::normal_distribution<double> normal;
    JointFilter filter = example::filter(vehicle, noise);
    // What it begins with is off by what it is said to be off by.
    ParameterVector begin = theta;
    const ParameterVector sigma = 0.1 * theta.cwiseAbs();
    for (Eigen::Index k = 0; k < begin.size(); ++k) begin(k) += sigma(k) * normal(engine);
    for (int axis : {0, 1, 2, 5})
      filter.teach(axis, begin, ParameterMatrix{sigma.cwiseAbs2().asDiagonal().toDenseMatrix()});
    Vector6d nu = Vector6d::Zero(), tau = Vector6d::Zero();
    filter.start(Eigen::Vector3d::Zero(), nu, Vector6d::Constant(0.01), 0.01);
    const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
    const Eigen::Vector3d none = Eigen::Vector3d::Zero(),
                          bias = 0.02 * Eigen::Vector3d{normal(engine), normal(engine), normal(engine)};
    int steps = 0;
    for (double t = 0.0; t < kDuration; t += kDt) {
      if (steps++ % 50 == 0)
        tau << 10.0 * normal(engine), 10.0 * normal(engine), 8.0 * normal(engine), 0.0, 0.0, normal(engine);
      Vector6d pushed = Vector6d::Zero();  // acceleration over the step that no model knows
      for (const int i : {0, 1, 2, 5})
        pushed[i] = (i < 3 ? noise.acceleration : noise.turning) / std::sqrt(kDt) * normal(engine);
      constexpr int kFine = 20;
      for (int k = 0; k < kFine; ++k) {
        const double h = kDt / kFine;
        const Vector6d middle = nu + 0.5 * h * (model.acceleration(truth, nu, I, tau) + pushed);
        nu += h * (model.acceleration(truth, middle, I, tau) + pushed);
      }
      filter.predict(kDt, I, I, I, tau);
      std::array<JointRow, 3> rows;
      see_velocity(filter.state(),
                   nu.head<3>() + kVelocity * Eigen::Vector3d{normal(engine), normal(engine), normal(engine)}, rows);
      for (JointRow& row : rows) row.variance = kVelocity * kVelocity;
      filter.update(rows, 1e9);
      for (int i = 0; i < 3; ++i) {
        auto& row = rows[static_cast<std::size_t>(i)];
        see_state(filter.state(), part::kNu + 3 + i, nu[3 + i] + kRate * normal(engine), row);
        row.variance = kRate * kRate;
      }
      filter.update(rows, 1e9);
      const Eigen::Vector3d a = (model.acceleration(truth, nu, I, tau) + pushed).head<3>();
      const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
      const Eigen::Vector3d f = a + w.cross(v) - Eigen::Vector3d{0.0, 0.0, 9.81} + bias +
                                kForce * Eigen::Vector3d{normal(engine), normal(engine), normal(engine)};
      feel_force(model, filter.state(),
                 {.told = I, .carried = I, .tau = tau, .w_dot = none, .p_BI = none, .gravity = 9.81}, f, rows);
      for (int i = 0; i < 3; ++i) {
        rows[static_cast<std::size_t>(i)].variance = kForce * kForce + noise.acceleration * noise.acceleration / kDt;
        rows[static_cast<std::size_t>(i)].shared[i] = noise.acceleration * noise.acceleration;
      }
      filter.update(rows, 1e9);
    }
    const ParameterVector off = filter.parameters() - truth;
    const double one = off.dot(Eigen::MatrixXd{filter.parameter_covariance()}.ldlt().solve(Eigen::VectorXd{off}));
    nees += one / kSeeds;
    largest = std::max(largest, one);
    const ParameterVector stated = filter.parameter_covariance().diagonal().cwiseSqrt();
    for (Eigen::Index k = 0; k < off.size(); ++k) inside += std::abs(off(k)) < 1.96 * stated(k) ? 1 : 0;
  }
  MESSAGE("NEES of 13 parameters, mean of ", kSeeds, " seeds: ", nees, ", largest ", largest,
          "; intervals that hold: ", 100.0 * inside / (13.0 * kSeeds), " %");
  // chi-squared: 40 times 13 degrees of freedom, 99.9 % within 13 +- 2.7; noise that acts in the accelerations of a
  // step and its velocity alike is shared to the first order only.
  CHECK(nees > 13.0 - 3.0);
  CHECK(nees < 13.0 + 3.0);
  CHECK(inside > 0.90 * 13 * kSeeds);
  CHECK(inside < 0.98 * 13 * kSeeds);
}
