// The output-error fit on simulated dives: the vehicle's numbers come back, and the stated standard deviations are
// true.
#include "common/identification/trajectories/trajectory_fit.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

FitSettings quick() {
  FitSettings settings;
  settings.window = 5.0;
  settings.threads = 1;
  settings.iterations = 6;
  return settings;
}

/// Four axes; ballast on a long frame keeps yaw from being so quick that steps must be short.
model::Vehicle four_axes() {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    if (vehicle.parameters[i] == "I_Z") vehicle.priors[i] = {.mean = 2.0, .sigma = 2.0};
  }
  return vehicle;
}

/// Of the free numbers, SI: the sandwich of linearise() with windows as clusters, so that correlation inside a window
/// is counted.
Eigen::VectorXd deviations(const TrajectoryFit& problem, const FitResult& fit) {
  const ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& free = map[static_cast<std::size_t>(i)];
    scale[i] = free.scale;
    information(i, i) = (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
  }
  Eigen::MatrixXd meat = information;
  for (const ProjectedWindow& window : problem.linearise(fit)) {
    information += window.jacobian.transpose() * window.jacobian;
    const Eigen::VectorXd gradient = window.jacobian.transpose() * window.residual;
    meat += gradient * gradient.transpose();
  }
  const auto clusters = static_cast<double>(problem.windows().size()), numbers = static_cast<double>(n);
  const double small_sample = clusters > numbers + 1.0 ? clusters / (clusters - numbers) : 2.0;
  const Eigen::MatrixXd inverse = information.inverse();
  return scale.cwiseProduct((small_sample * inverse * meat * inverse).diagonal().cwiseSqrt());
}

/// Errors over standard deviations, of the base parameters that the file enables.
std::vector<double> normalised_errors(const TrajectoryFit& problem, const FitResult& fit, const model::Model& truth) {
  const ParameterMap map{fit.model};
  const Eigen::VectorXd sigma = deviations(problem, fit);
  std::vector<double> errors;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].base < 0) continue;
    errors.push_back((fit.model.theta[map[i].base] - truth.theta[map[i].base]) / sigma[static_cast<Eigen::Index>(i)]);
  }
  return errors;
}

}  // namespace

TEST_CASE("trajectory fit: four axes, ten noisy dives: numbers within 3 sigma, and sigma honest") {
  const model::Vehicle vehicle = four_axes();
  double square = 0.0, count = 0.0, beyond = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 120.0, .seed = seed});
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, quick()};
    const FitResult fit = problem.fit(model::nominal_model(vehicle, false));
    for (const double error : normalised_errors(problem, fit, dive.truth)) {
      square += error * error;
      count += 1.0;
      beyond += std::abs(error) > 3.0 ? 1.0 : 0.0;
    }
  }
  REQUIRE(count == 130.0);
  // 130 normalised errors, correlated within a dive: 0.6..1.6 is about four standard deviations of their mean square,
  // and the sandwich of some twenty windows is itself uncertain by a fifth.
  const double spread = std::sqrt(square / count);
  MESSAGE("rms of error over stated sigma: " << spread << ", beyond 3 sigma: " << beyond << " of " << count);
  CHECK(spread > 0.6);
  CHECK(spread < 1.6);
  CHECK(beyond <= 4.0);  // expected 0.4 when normal, some more with so few windows
}

TEST_CASE("trajectory fit: six axes") {
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 160.0, .seed = 3, .spread = 0.05});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, quick()};
  const FitResult fit = problem.fit(model::nominal_model(vehicle, false));
  double beyond = 0.0;
  for (const double error : normalised_errors(problem, fit, dive.truth)) beyond += std::abs(error) > 3.0 ? 1.0 : 0.0;
  CHECK(beyond <= 1.0);  // of 22
  // What is left is the noise that was put in.
  CHECK(fit.sigma[0] == doctest::Approx(0.005).epsilon(0.1));
  CHECK(fit.sigma[5] == doctest::Approx(0.005).epsilon(0.1));
}

TEST_CASE("trajectory fit: the derivatives are those of the residual, and costs add up") {
  const model::Vehicle vehicle = four_axes();
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 30.0, .seed = 5});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, quick()};
  FitResult fit = problem.fit(dive.truth);
  double sum = 0.0;
  for (const double cost : fit.window_cost) sum += cost;
  CHECK(fit.cost == doctest::Approx(sum));

  const ParameterMap map{fit.model};
  const WindowResidual& window = problem.windows().front();
  model::VelocityTrace trace;
  Eigen::VectorXd at(window.rows()), plus(window.rows()), minus(window.rows());
  window.evaluate(fit.model, fit.nu0[0], fit.sigma, trace, at);
  Eigen::MatrixXd jacobian, initial;
  window.jacobians(fit.model, map, fit.nu0[0], fit.sigma, at, jacobian, initial);
  constexpr double kStep = 1e-3;
  constexpr double kAgreement = 1e-2;  // of a column: the variational equation takes one slope per step of 50 ms
  const Eigen::VectorXd x = map.pack(fit.model);
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    model::Model moved = fit.model;
    map.unpack(x + kStep * Eigen::VectorXd::Unit(x.size(), j), moved);
    window.evaluate(moved, fit.nu0[0], fit.sigma, trace, plus);
    map.unpack(x - kStep * Eigen::VectorXd::Unit(x.size(), j), moved);
    window.evaluate(moved, fit.nu0[0], fit.sigma, trace, minus);
    const Eigen::VectorXd central = (plus - minus) / (2.0 * kStep);
    CAPTURE(map[static_cast<std::size_t>(j)].name);
    CHECK((jacobian.col(j) - central).norm() <= kAgreement * central.norm() + 1e-6);
  }
}

TEST_CASE("trajectory fit: no usable stretch is an error that says what to do") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 3.0});
  dive.trial.name = "dive-1";
  std::fill(dive.trial.pose_valid.begin(), dive.trial.pose_valid.end(), std::uint8_t{0});
  CHECK_THROWS_WITH_AS((TrajectoryFit{vehicle, {&dive.trial, 1}, quick()}),
                       doctest::Contains("dive-1 is 3 s long, its pose valid for 0 %, its velocity valid for 100 %"),
                       InputError);
}

TEST_CASE("trajectory fit: an effect fifty times what is ordinary for it comes back whole") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  constexpr double kCubic = 2500.0;  // N/(m/s)^3
  const model::ActiveEffect cubic = test::active("cubic_drag", {kCubic}, 1);
  REQUIRE(kCubic == doctest::Approx(50.0 * cubic.effect->parameters()[0].sigma));
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 120.0, .seed = 7, .effects = {cubic}});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, quick()};
  const FitResult fit = problem.fit(dive.truth);
  const double found = fit.model.effects.front().theta[0], sigma = deviations(problem, fit).tail<1>()[0];
  CAPTURE(found);
  CAPTURE(sigma);
  CHECK(std::abs(found - kCubic) < 3.0 * sigma);
}

TEST_CASE("trajectory fit: a quick look lets a number go that starts at its bound") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  constexpr double kExponent = 1.0;
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 120.0, .seed = 9, .effects = {test::active("battery_sag", {kExponent})}});
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, quick()};
  const FitResult base = problem.fit(model::nominal_model(vehicle, false));
  model::Model start = base.model;
  const double bound = dive.truth.effects.front().effect->parameters()[0].high;
  start.effects.push_back(test::active("battery_sag", {bound}));
  constexpr double kQuick = 1e-3;  // of the cost, as where candidates are compared
  const FitResult found = problem.fit(start, &base, kQuick);
  CHECK(found.model.effects.front().theta[0] == doctest::Approx(kExponent).epsilon(0.1));
}
