// Recursive least squares against batch solutions in long double, brute force projections and repeated trials.
#include "common/identification/recursive.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "common/base/error.hpp"

using namespace fathom::identification;

namespace {

RecursiveSettings settings(int n, double sigma, double forgetting = 1.0) {
  RecursiveSettings s;
  s.mean = ParameterVector::Zero(n);
  s.sigma = ParameterVector::Constant(n, sigma);
  s.forgetting = forgetting;
  return s;
}

Row row(int axis, const ParameterVector& h, double y, double variance) {
  return {.axis = axis, .h = h, .y = y, .variance = variance};
}

struct Noise {
  std::mt19937_64 engine;
  std::normal_distribution<double> normal{0.0, 1.0};
  explicit Noise(unsigned seed) : engine(seed) {}
  double operator()() { return normal(engine); }
  ParameterVector vector(int n) {
    ParameterVector x(n);
    for (int i = 0; i < n; ++i) x(i) = (*this)();
    return x;
  }
};

}  // namespace

TEST_CASE("recursive: 660,000 updates with forgetting agree with a long double batch solution") {
  // Nearly two hours at 100 Hz: 165,000 steps of four rows. Columns differ in scale by 1e4 and are correlated, as
  // masses and quadratic drag are. The batch solution accumulates and solves normal equations in long double.
  constexpr double kTolerance = 1e-9;  // relative; double keeps 1e-16 per operation, normal equations would lose 1e-7
  constexpr int kParameters = 13;
  constexpr int kSteps = 165000;
  constexpr double kForgetting = 0.9999;
  using Matrix = Eigen::Matrix<long double, kParameters, kParameters>;
  using Vector = Eigen::Matrix<long double, kParameters, 1>;
  Noise noise{3};
  RecursiveSettings s = settings(kParameters, 1e3, kForgetting);
  s.cap = ParameterVector::Constant(kParameters, 1e9);
  RecursiveEstimator estimator{s};
  Matrix A = Matrix::Identity() * (1.0L / 1e6L);
  Vector b = Vector::Zero();
  const ParameterVector theta = noise.vector(kParameters) * 10.0;
  ParameterVector scale(kParameters);
  for (int i = 0; i < kParameters; ++i) scale(i) = std::pow(10.0, 2.0 * std::sin(1.7 * i));
  std::vector<Row> rows(4);
  for (int step = 0; step < kSteps; ++step) {
    const double common = noise();
    A *= static_cast<long double>(kForgetting);
    b *= static_cast<long double>(kForgetting);
    for (int axis = 0; axis < 4; ++axis) {
      ParameterVector h = noise.vector(kParameters);
      h.array() += 10.0 * common;
      h = h.cwiseProduct(scale);
      const double y = h.dot(theta) + 0.5 * noise();
      rows[static_cast<std::size_t>(axis)] = row(axis, h, y, 0.25 + 0.1 * axis);
      const Vector h_long = h.cast<long double>();
      A.selfadjointView<Eigen::Lower>().rankUpdate(h_long, 1.0L / (0.25L + 0.1L * axis));
      b += h_long * (static_cast<long double>(y) / static_cast<long double>(0.25 + 0.1 * axis));
    }
    estimator.step(rows);
  }
  const Matrix full = A.selfadjointView<Eigen::Lower>();
  const Vector batch = full.llt().solve(b);
  const Matrix P = full.llt().solve(Matrix::Identity());
  const double error =
      static_cast<double>((estimator.unconstrained().cast<long double>() - batch).norm() / batch.norm());
  CHECK(estimator.state().updates == 660000);
  CHECK(error < kTolerance);
  double worst = 0.0;
  const ParameterMatrix covariance = estimator.covariance();
  for (int i = 0; i < kParameters; ++i) {
    CHECK(std::abs(static_cast<double>(estimator.unconstrained()(i) - batch(i))) <
          kTolerance * std::abs(static_cast<double>(batch(i))));
    worst = std::max(worst, std::abs(covariance(i, i) / static_cast<double>(P(i, i)) - 1.0));
  }
  CHECK(worst < kTolerance);
  MESSAGE("relative difference: estimate " << error << ", variances " << worst);
}

TEST_CASE("projection: beats every combination of held parameters, by enumeration") {
  constexpr double kTolerance = 1e-9;  // two direct solutions of systems of condition below 1e4
  constexpr int n = 6;
  Noise noise{11};
  int moved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return noise(); });
    const ParameterMatrix P = root * root.transpose() + 0.05 * Eigen::MatrixXd::Identity(n, n);
    const ParameterVector x_hat = 2.0 * noise.vector(n);
    Signs signs{};
    for (std::size_t i = 0; i < n; ++i) signs[i] = static_cast<std::int8_t>(static_cast<int>(i % 3) - 1);
    const Eigen::MatrixXd information = P.inverse();
    double best = 1e300;
    ParameterVector best_x = x_hat;
    for (unsigned held = 0; held < (1U << n); ++held) {
      // x = x_hat - P_A P_AA^-1 x_hat_A
      std::vector<int> A;
      for (int i = 0; i < n; ++i) {
        if (held & (1U << i)) A.push_back(i);
      }
      Eigen::VectorXd x = x_hat;
      if (!A.empty()) x -= P(Eigen::all, A) * Eigen::MatrixXd(P(A, A)).ldlt().solve(Eigen::VectorXd(x_hat(A)));
      for (const int i : A) x(i) = 0.0;
      if (!obeys(x, signs)) continue;
      const double cost = (x - x_hat).dot(information * (x - x_hat));
      if (cost < best) {
        best = cost;
        best_x = x;
      }
    }
    const ParameterVector x = project_on_signs(x_hat, P, signs);
    CHECK(obeys(x, signs));
    CHECK((x - best_x).norm() < kTolerance * (1.0 + best_x.norm()));
    moved += (x - x_hat).norm() > 0.0 ? 1 : 0;
  }
  CHECK(moved > 200);
}

TEST_CASE("recursive: the report obeys the signs, and what lies beneath is left alone") {
  RecursiveSettings s = settings(2, 10.0);
  s.signs[0] = +1;
  s.signs[1] = -1;
  RecursiveEstimator estimator{s};
  RecursiveSettings free = settings(2, 10.0);
  RecursiveEstimator unconstrained{free};
  Noise noise{5};
  for (int i = 0; i < 50; ++i) {
    const ParameterVector h = noise.vector(2);
    const Row r = row(0, h, h(0) * 3.0 + h(1) * 0.5 + 0.1 * noise(), 0.01);  // the second one breaks its sign
    estimator.step({&r, 1});
    unconstrained.step({&r, 1});
    (void)estimator.report();
  }
  const RecursiveReport report = estimator.report();
  CHECK(report.active[1]);
  CHECK(report.estimate(1) == 0.0);
  CHECK(report.estimate(0) > 0.0);
  CHECK(estimator.unconstrained() == unconstrained.unconstrained());
  CHECK(estimator.projected() == report.estimate);
}

TEST_CASE("recursive: a frozen parameter keeps its value and its doubt widens the others (Schmidt)") {
  // y = a + b with b frozen at 0 +- 2: however many rows, they cannot settle a. Dense formula as the oracle.
  constexpr double kTolerance = 1e-9;  // 40 dense updates of condition below 1e5
  RecursiveSettings s = settings(3, 2.0, 0.99);
  s.cap = ParameterVector::Constant(3, 1e3);
  RecursiveEstimator estimator{s};
  estimator.freeze(1);
  Eigen::Matrix3d P = 4.0 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  const Eigen::Vector3d grow{1.0 / std::sqrt(0.99), 1.0, 1.0 / std::sqrt(0.99)};
  Noise noise{9};
  for (int i = 0; i < 40; ++i) {
    Eigen::Vector3d h{1.0, 1.0, noise()};
    const double y = 5.0 * h(0) + 1.0 * h(1) - 2.0 * h(2) + 0.1 * noise();
    const Row r = row(0, h, y, 0.01);
    estimator.step({&r, 1});
    P = grow.asDiagonal() * P * grow.asDiagonal();
    Eigen::Vector3d K = P * h / (h.dot(P * h) + 0.01);
    K(1) = 0.0;
    const Eigen::Matrix3d A = Eigen::Matrix3d::Identity() - K * h.transpose();
    x += K * (y - h.dot(x));
    P = Eigen::Matrix3d(A * P * A.transpose() + 0.01 * K * K.transpose());
  }
  CHECK((estimator.unconstrained() - x).norm() < kTolerance);
  CHECK((estimator.covariance() - P).norm() < kTolerance * P.norm());
  CHECK(estimator.unconstrained()(1) == 0.0);
  CHECK(estimator.covariance()(1, 1) == doctest::Approx(4.0));
  CHECK(estimator.covariance()(0, 0) > 2.0);  // half of the prior's 4: y cannot say which of the two it was
  // Resumed, with rows that tell them apart, all three are found.
  estimator.resume(1);
  for (int i = 0; i < 400; ++i) {
    const ParameterVector h = noise.vector(3);
    const Row r = row(0, h, 5.0 * h(0) + 1.0 * h(1) - 2.0 * h(2) + 0.1 * noise(), 0.01);
    estimator.step({&r, 1});
  }
  const Eigen::Vector3d truth{5.0, 1.0, -2.0};
  constexpr double kRecovered = 0.06;  // 0.1 / sqrt(100 effective rows), six sigma
  CHECK((estimator.unconstrained() - truth).cwiseAbs().maxCoeff() < kRecovered);
}

TEST_CASE("recursive: what nobody excites does not grow beyond its cap, the rest goes on forgetting") {
  RecursiveSettings s = settings(2, 3.0, 0.98);
  RecursiveEstimator estimator{s};
  Noise noise{2};
  double value = 1.0;
  for (int i = 0; i < 20000; ++i) {
    if (i == 10000) value = 2.0;
    const Eigen::Vector2d h{1.0, 0.0};
    const Row r = row(0, h, value + 0.1 * noise(), 0.01);
    estimator.step({&r, 1});
  }
  const ParameterMatrix P = estimator.covariance();
  CHECK(P(1, 1) <= 9.0 * (1.0 + 1e-9));
  CHECK(P(1, 1) > 8.9);
  CHECK(P(0, 0) == doctest::Approx(0.01 * 0.02).epsilon(0.01));  // variance (1 - forgetting): a memory of 50 rows
  CHECK(estimator.unconstrained()(0) == doctest::Approx(2.0).epsilon(0.03));
}

TEST_CASE("recursive: claimed sigmas hold under coloured residuals, where the nominal ones are far too small") {
  // A slowly varying regressor and AR(1) noise, 200 trials: squared errors over claimed variances should average 1.
  constexpr int kTrials = 200;
  double honest = 0.0;
  double nominal = 0.0;
  double lag = 0.0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    Noise noise{100 + trial};
    RecursiveEstimator estimator{settings(2, 100.0)};
    double e = noise();
    double x = noise();
    for (int k = 0; k < 3000; ++k) {
      e = 0.9 * e + std::sqrt(1.0 - 0.81) * noise();
      x = 0.95 * x + std::sqrt(1.0 - 0.9025) * noise();
      const Eigen::Vector2d h{x, 1.0};
      const Row r = row(2, h, 3.0 * x - 1.0 + e, 1.0);
      estimator.step({&r, 1});
    }
    const RecursiveReport report = estimator.report();
    const Eigen::Vector2d error = estimator.unconstrained() - ParameterVector(Eigen::Vector2d{3.0, -1.0});
    const ParameterMatrix P = estimator.covariance();
    for (int i = 0; i < 2; ++i) {
      honest += error(i) * error(i) / report.covariance(i, i) / (2.0 * kTrials);
      nominal += error(i) * error(i) / P(i, i) / (2.0 * kTrials);
    }
    lag += estimator.state().axes[2].lag1() / kTrials;
  }
  CHECK(nominal > 8.0);
  CHECK(honest > 0.6);  // 400 squared normals: sigma of the mean 0.07 if independent, taken three times wider for both
  CHECK(honest < 1.4);  // the pairing within a trial and the AR(1) approximation of the score
  CHECK(lag == doctest::Approx(0.9).epsilon(0.02));
  MESSAGE("normalised squared error: nominal " << nominal << ", honest " << honest << ", lag-1 " << lag);
}

TEST_CASE("recursive: white residuals of the stated size are not punished, larger ones are") {
  Noise noise{4};
  RecursiveEstimator right{settings(3, 100.0)};
  RecursiveEstimator wrong{settings(3, 100.0)};
  for (int k = 0; k < 4000; ++k) {
    const ParameterVector h = noise.vector(3);
    const double e = noise();
    const Row a = row(0, h, h.sum() + e, 1.0);
    const Row b = row(0, h, h.sum() + 2.0 * e, 1.0);
    right.step({&a, 1});
    wrong.step({&b, 1});
  }
  CHECK(right.report().inflation.maxCoeff() < 1.2);
  CHECK(wrong.report().inflation.minCoeff() > 3.5);
  CHECK(right.state().axes[0].variance == doctest::Approx(1.0).epsilon(0.1));
  CHECK(std::abs(right.state().axes[0].mean) < 0.06);
  CHECK(std::abs(right.state().axes[0].lag1()) < 0.06);
}

// Stated is four times the noise there is. The estimate's normalised square error must come out as one all the same.
TEST_CASE("recursive: residuals smaller than stated narrow the intervals by as much, but not after a few of them") {
  constexpr int kTrials = 200;
  double honest = 0.0, stated = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Noise noise{static_cast<unsigned>(900 + trial)};
    RecursiveEstimator estimator{settings(2, 100.0)};
    for (int k = 0; k < 3000; ++k) {
      const ParameterVector h = noise.vector(2);
      const Row r = row(1, h, h.sum() + 0.25 * noise(), 1.0);
      estimator.step({&r, 1});
      if (k == 9) CHECK(estimator.report().inflation.minCoeff() > 0.5);  // 20 stated against 10 seen: 0.69 on average
    }
    const RecursiveReport report = estimator.report();
    const ParameterMatrix P = estimator.covariance();
    for (int i = 0; i < 2; ++i) {
      const double error = estimator.unconstrained()(i) - 1.0;
      honest += error * error / report.covariance(i, i) / (2.0 * kTrials);
      stated += error * error / P(i, i) / (2.0 * kTrials);
    }
  }
  CHECK(stated < 0.1);
  CHECK(honest > 0.6);  // 400 squared normals: 0.07, taken four times; 0.9 by what the statement still counts
  CHECK(honest < 1.2);
}

// Windows that overlap correlate over one step and no further; an AR(1) with that correlation would go on.
TEST_CASE("recursive: residuals of overlapping windows do not count as ones with a memory") {
  constexpr int kTrials = 200;
  double honest = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Noise noise{static_cast<unsigned>(1700 + trial)};
    RecursiveEstimator estimator{settings(1, 100.0)};
    double before = noise();
    for (int k = 0; k < 3000; ++k) {
      const double e = noise();
      ParameterVector h(1);
      h << 1.0;
      const Row r = row(1, h, 2.0 + (e + before) / std::sqrt(2.0), 1.0);
      before = e;
      estimator.step({&r, 1});
    }
    const double error = estimator.unconstrained()(0) - 2.0;
    honest += error * error / estimator.report().covariance(0, 0) / kTrials;
  }
  CHECK(honest > 0.7);  // 200 squared normals: 0.1, taken three times; AR(1) would make it 0.67
  CHECK(honest < 1.3);
}

// An error of the velocity between two windows has one sign in the first and the other in the second: it does not add
// up, and steps that follow one another closely do not show that.
TEST_CASE("recursive: noise that swings back after a window does not count as if it stayed") {
  constexpr int kTrials = 400, kWindow = 4;
  double honest = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Noise noise{static_cast<unsigned>(2700 + trial)};
    RecursiveEstimator estimator{settings(1, 100.0)};
    std::vector<double> velocity(kWindow);
    for (double& one : velocity) one = noise();
    for (int k = 0; k < 3000; ++k) {
      velocity.push_back(noise());
      const double swings = (velocity.back() - velocity[velocity.size() - 1 - kWindow]) / std::sqrt(2.0);
      ParameterVector h(1);
      h << 1.0;
      const Row r = row(1, h, 2.0 + 0.9 * swings + std::sqrt(1.0 - 0.81) * noise(), 1.0);
      estimator.step({&r, 1});
    }
    const double error = estimator.unconstrained()(0) - 2.0;
    honest += error * error / estimator.report().covariance(0, 0) / kTrials;
  }
  CHECK(honest > 0.25);  // Bartlett's window gives that lag half of its weight: 0.32; none without the lag: 0.19
  CHECK(honest < 1.3);
}

TEST_CASE("recursive: a saved state resumes to the same bits, and a foreign one is refused") {
  Noise noise{6};
  RecursiveEstimator first{settings(5, 10.0, 0.999)};
  RecursiveEstimator second{settings(5, 10.0, 0.999)};
  std::vector<Row> rows;
  for (int i = 0; i < 100; ++i) rows.push_back(row(i % 6, noise.vector(5), noise(), 0.5));
  for (int i = 0; i < 50; ++i) first.step({&rows[static_cast<std::size_t>(i)], 1});
  second.restore(first.state());
  for (int i = 50; i < 100; ++i) {
    first.step({&rows[static_cast<std::size_t>(i)], 1});
    second.step({&rows[static_cast<std::size_t>(i)], 1});
  }
  CHECK(first.unconstrained() == second.unconstrained());
  CHECK(first.covariance() == second.covariance());
  RecursiveEstimator other{settings(4, 10.0)};
  CHECK_THROWS_AS(other.restore(first.state()), fathom::InputError);
  RecursiveEstimator::State broken = first.state();
  broken.D(2) = -1.0;
  CHECK_THROWS_AS(second.restore(broken), fathom::InputError);
  CHECK_THROWS_AS((RecursiveEstimator{settings(3, 0.0)}), fathom::InputError);
  first.reset();
  CHECK(first.unconstrained().norm() == 0.0);
  CHECK(first.state().updates == 0);
}

TEST_CASE("recursive: one violated sign goes the short way to the same point as the general projection") {
  std::mt19937 engine{12};
  std::normal_distribution<double> normal;
  int checked = 0;
  for (int round = 0; round < 200; ++round) {
    RecursiveSettings settings;
    settings.mean = ParameterVector::Zero(6);
    settings.sigma = ParameterVector::Constant(6, 10.0);
    settings.signs = {1, -1, 1, -1, 0, 1};
    RecursiveEstimator estimator{settings};
    for (int k = 0; k < 12; ++k) {
      Row row{.axis = 0, .h = ParameterVector::Zero(6), .y = normal(engine), .variance = 0.5};
      for (Eigen::Index i = 0; i < 6; ++i) row.h(i) = normal(engine);
      estimator.step(std::span{&row, 1});
    }
    const ParameterVector general = project_on_signs(estimator.unconstrained(), estimator.covariance(), settings.signs);
    CHECK((estimator.projected() - general).cwiseAbs().maxCoeff() < 1e-9);  // rounding of two orders of summing
    int violated = 0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      violated += estimator.unconstrained()(i) * settings.signs[static_cast<std::size_t>(i)] < 0.0 ? 1 : 0;
    }
    checked += violated == 1 ? 1 : 0;
  }
  CHECK(checked > 20);
}
