// The identities hold for a motion that is known at every instant; what breaks them enters by the columns that say so.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "common/consistency/pairs/pair.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom::consistency {

using estimation::make_continuous;
namespace {

constexpr double kStep = 0.02;  // s
constexpr int kSamples = 600;
// Quadrature over windows of 0.8 s with an error of the step's fourth power, and motions of 0.5 Hz.
constexpr double kAngleError = 2e-6, kLengthError = 2e-6, kAccelerationError = 2e-4;

const test::SyntheticMotion& motion() {
  static const test::SyntheticMotion kMotion{3};
  return kMotion;
}

PoseSeries exact_pose() {
  PoseSeries pose;
  for (int i = 0; i < kSamples; ++i) {
    const double t = i * kStep;
    pose.t.push_back(t);
    pose.p_WB.push_back(motion().p_WB(t));
    pose.q_WB.emplace_back(motion().R_WB(t));
    pose.valid.push_back(1);
  }
  make_continuous(pose.q_WB);
  pose.has_position = pose.has_attitude = true;
  return pose;
}

/// Largest misfit of y = sum basis sensor + fixed theta over all windows.
double misfit(const IncrementProblem& problem, const std::function<Eigen::Vector3d(double)>& sensor,
              const Eigen::VectorXd& theta) {
  double worst = 0.0;
  for (std::size_t w = 0; w < problem.windows.size(); ++w) {
    const IncrementProblem::Window& window = problem.windows[w];
    Eigen::Vector3d sum = problem.fixed[w] * theta;
    for (int s = 0; s < window.count; ++s) {
      sum += problem.basis[static_cast<std::size_t>(window.basis + s)] *
             sensor(problem.t[static_cast<std::size_t>(window.first + s)]);
    }
    worst = std::max(worst, (problem.y[w] - sum).norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("rate problem: attitude increments are the integral of the true rates, and a bias has its columns") {
  const IncrementProblem problem = rate_problem(exact_pose());
  REQUIRE(problem.windows.size() > 50);
  REQUIRE(problem.fixed_columns == 3);
  CHECK(problem.lever == -1);
  CHECK(misfit(
            problem, [](double t) { return motion().w_B(t); }, Eigen::VectorXd::Zero(3)) < kAngleError);
  const Eigen::Vector3d bias(0.02, -0.01, 0.03);
  const auto biased = [&](double t) { return Eigen::Vector3d(motion().w_B(t) - bias); };
  CHECK(misfit(problem, biased, bias) < kAngleError);
  CHECK(misfit(problem, biased, Eigen::VectorXd::Zero(3)) > 100.0 * kAngleError);
}

TEST_CASE("velocity problem: bias, lever arm and heading offset each enter by their own columns") {
  const PoseSeries pose = exact_pose();
  const IncrementProblem problem = velocity_problem(pose, nullptr);
  REQUIRE(problem.fixed_columns == 7);
  REQUIRE(problem.lever == 3);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(7);
  CHECK(misfit(
            problem, [](double t) { return motion().v_B(t); }, theta) < kLengthError);
  const Eigen::Vector3d bias(0.05, 0.0, -0.02), lever(0.4, -0.2, 0.7);
  theta.head<3>() = bias;
  theta.segment<3>(3) = lever;
  const auto sensor = [&](double t) { return Eigen::Vector3d(motion().v_B(t) + motion().w_B(t).cross(lever) - bias); };
  CHECK(misfit(problem, sensor, theta) < kLengthError);
  theta[4] = 0.0;
  CHECK(misfit(problem, sensor, theta) > 100.0 * kLengthError);
  // An attitude turned about the vertical by a small angle, to first order.
  constexpr double kOffset = 1e-3, kSecondOrder = 1e-6;
  PoseSeries turned = pose;
  for (Eigen::Quaterniond& q : turned.q_WB) q = Eigen::AngleAxisd(kOffset, Eigen::Vector3d::UnitZ()) * q;
  theta.setZero();
  theta[6] = -kOffset;
  const IncrementProblem offset = velocity_problem(turned, nullptr);
  const auto true_velocity = [](double t) { return motion().v_B(t); };
  const double right = misfit(offset, true_velocity, theta);
  theta[6] = kOffset;
  const double wrong = misfit(offset, true_velocity, theta);
  CHECK(std::min(right, wrong) < kLengthError + kSecondOrder);
  CHECK(std::max(right, wrong) > 10.0 * std::min(right, wrong));
}

TEST_CASE("velocity problem: couplings to the rates have their columns, and windows without rates are left out") {
  const PoseSeries pose = exact_pose();
  Series rates;
  for (double t = -1.0; t < kSamples * kStep + 1.0; t += kStep) {
    rates.t.push_back(t);
    rates.x.push_back(motion().w_B(t));
  }
  const IncrementProblem problem = velocity_problem(pose, &rates);
  REQUIRE(problem.fixed_columns == 13);
  for (std::size_t k = 0; k < kSymmetric.size(); ++k) {
    const auto [a, b] = kSymmetric[k];
    Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
    coupling(a, b) = coupling(b, a) = 0.02;
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(13);
    theta[7 + static_cast<Eigen::Index>(k)] = 0.02;
    const auto sensor = [&](double t) { return Eigen::Vector3d(motion().v_B(t) - coupling * motion().w_B(t)); };
    CHECK(misfit(problem, sensor, theta) < kLengthError);
    CHECK(misfit(problem, sensor, Eigen::VectorXd::Zero(13)) > 10.0 * kLengthError);
  }
  const std::size_t half = rates.t.size() / 2;
  rates.t.resize(half);
  rates.x.resize(half);
  const std::size_t left = velocity_problem(pose, &rates).windows.size();
  CHECK(left > 0);
  CHECK(left < problem.windows.size());
}

TEST_CASE("acceleration problem: second differences of position are the triangle mean of specific force and gravity") {
  const IncrementProblem problem = acceleration_problem(exact_pose());
  REQUIRE(problem.fixed_columns == 3);
  REQUIRE(problem.lever == 0);
  CHECK(misfit(
            problem, [](double t) { return motion().f_B(t); }, Eigen::VectorXd::Zero(3)) < kAccelerationError);
  // Without gravity the two sides differ by it.
  const auto weightless = [](double t) {
    return Eigen::Vector3d(motion().f_B(t) + 9.81 * motion().R_WB(t).transpose().col(2));
  };
  CHECK(misfit(problem, weightless, Eigen::VectorXd::Zero(3)) == doctest::Approx(9.81).epsilon(0.01));
}

TEST_CASE("increment windows reach across no gap and no invalid pose") {
  PoseSeries pose = exact_pose();
  const std::size_t whole = rate_problem(pose).windows.size();
  pose.valid[300] = 0;
  for (std::size_t i = 450; i < pose.size(); ++i) pose.t[i] += 3.0 * kStep;
  const IncrementProblem problem = rate_problem(pose);
  CHECK(problem.windows.size() < whole);
  for (const IncrementProblem::Window& window : problem.windows) {
    const bool over_invalid = window.first <= 300 && window.first + window.count > 300;
    const bool over_gap = window.first < 450 && window.first + window.count > 450;
    CHECK_FALSE(over_invalid);
    CHECK_FALSE(over_gap);
  }
  CHECK(rate_problem(PoseSeries{}).windows.empty());
}

}  // namespace fathom::consistency
