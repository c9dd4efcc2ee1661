// Whiteness against theory: uniform p-values on noise, and the memory of an AR(1) residual.
#include "common/residual/whiteness.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "common/residual/force_residual.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::residual;

namespace {

std::vector<double> autoregression(double phi, std::size_t count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<double> x(count);
  double last = 0.0;
  for (double& value : x) value = last = phi * last + normal(random);
  return x;
}

Trial quiet_trial(std::size_t count) {
  Trial trial;
  trial.dt = 0.1;
  trial.observed = {true, true, true, true};
  for (std::size_t k = 0; k < count; ++k) {
    trial.t.push_back(0.1 * static_cast<double>(k));
    trial.p_WB.emplace_back(0, 0, 0);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Zero());
    trial.pose_valid.push_back(1);
    trial.velocity_valid.push_back(1);
    trial.rates_valid.push_back(1);
    trial.input.emplace_back(Eigen::VectorXd::Unit(6, 0) * std::sin(0.05 * static_cast<double>(k)));
  }
  return trial;
}

}  // namespace

TEST_CASE("whiteness: noise of the velocities makes the share of the residual that theory gives") {
  static const model::Vehicle kVehicle = test::vehicle_from_repository("bluerov2");
  Trial trial = quiet_trial(4000);
  std::mt19937 random{5};
  std::normal_distribution<double> noise{0.0, 0.02};
  for (auto& nu : trial.nu) nu[0] = noise(random);
  trial.nu_sigma[0] = 0.02;
  model::Model model = model::nominal_model(kVehicle, true);
  model.theta[model::index(model::BaseParameter::X_u)] = 0.0;
  model.theta[model::index(model::BaseParameter::X_uu)] = 0.0;
  for (auto& input : trial.input) input *= 1e-3;  // what is left is noise
  const std::vector<std::vector<Vector6d>> residuals{wrench_residuals(model, trial)};
  const auto rows = whiteness(model, {&trial, 1}, residuals);
  REQUIRE(rows.front().axis == "X");
  // 570 independent means: their variance is known to 6 %.
  CHECK(rows.front().noise == doctest::Approx(1.0 - rows.front().explained).epsilon(0.25));
  CHECK_FALSE(rows.front().swings());
}

TEST_CASE("whiteness: autocorrelation by hand, gaps left out") {
  const std::vector<double> series{1, -1, 1, -1};
  const auto rho = autocorrelation(series, 2);
  CHECK(rho[0] == doctest::Approx(1.0));
  CHECK(rho[1] == doctest::Approx(-1.0));
  CHECK(rho[2] == doctest::Approx(1.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(autocorrelation(std::vector{1.0, -1.0, nan, -1.0, 1.0}, 1)[1] == doctest::Approx(-1.0));
}

TEST_CASE("whiteness: p-values of white noise are uniform, those of coloured noise are not") {
  std::mt19937 random{3};
  std::vector<double> p;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const auto series = autoregression(0.0, 500, random);
    p.push_back(ljung_box_p(autocorrelation(series, 20), 500.0));
  }
  std::sort(p.begin(), p.end());
  double distance = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    distance = std::max(distance, std::abs(p[i] - (static_cast<double>(i) + 0.5) / kRuns));
  }
  CHECK(distance < 1.63 / std::sqrt(kRuns) + 0.01);  // Kolmogorov's 1 % bound; 0.01 for the cube-root tail
  const auto coloured = autoregression(0.5, 500, random);
  CHECK(ljung_box_p(autocorrelation(coloured, 20), 500.0) < 1e-6);
}

TEST_CASE("whiteness: an AR(1) residual has the memory that theory gives") {
  model::Vehicle vehicle;
  vehicle.dof[0] = true;
  const model::Model model = model::nominal_model(vehicle, true);
  std::mt19937 random{4};
  constexpr double kPhi = 0.9;
  const std::vector<Trial> trials{quiet_trial(20000)};
  const auto series = autoregression(kPhi, 20000, random);
  std::vector<std::vector<Vector6d>> residuals(1);
  for (const double value : series) residuals[0].push_back(Vector6d::Unit(0) * value);
  const auto rows = whiteness(model, trials, residuals);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].axis == "X");
  CHECK(rows[0].p_value < 1e-6);
  // Integral of phi^|lag|, trapezoidal from lag 0: dt (1/2 + phi / (1 - phi)).
  CHECK(rows[0].autocorrelation_time_s == doctest::Approx(0.1 * (0.5 + kPhi / (1.0 - kPhi))).epsilon(0.2));
}

TEST_CASE("whiteness: what swings over a band of frequencies has a period, a random force that forgets has none") {
  constexpr double kStep = 0.5, kPeriod = 5.0;  // s
  constexpr std::size_t kCount = 330, kLags = 60;
  constexpr int kRuns = 300;
  std::mt19937 random{6};
  std::normal_distribution<double> normal;
  int found = 0, false_alarms = 0;
  for (int run = 0; run < kRuns; ++run) {
    // Sixty tones about the middle one, a fifth of it wide, and as much noise as signal over ten.
    std::vector<double> swings(kCount, 0.0);
    for (int tone = 0; tone < 60; ++tone) {
      const double omega = 2.0 * std::numbers::pi / kPeriod * (1.0 + 0.1 * normal(random));
      const double cosine = normal(random), sine = normal(random);
      for (std::size_t k = 0; k < kCount; ++k) {
        const double phase = omega * kStep * static_cast<double>(k);
        swings[k] += cosine * std::cos(phase) + sine * std::sin(phase);
      }
    }
    for (double& value : swings) value += 2.4 * normal(random);
    const double period = swing_period(autocorrelation(swings, kLags), kStep, kCount);
    found += std::abs(period - kPeriod) < 0.1 * kPeriod ? 1 : 0;
    for (const double phi : {0.0, 0.6, 0.9}) {
      const auto forgets = autoregression(phi, kCount, random);
      false_alarms += std::isfinite(swing_period(autocorrelation(forgets, kLags), kStep, kCount)) ? 1 : 0;
    }
  }
  MESSAGE("found ", found, " of ", kRuns, ", false ", false_alarms, " of ", 3 * kRuns);
  CHECK(found > kRuns * 9 / 10);
  CHECK(false_alarms < 3 * kRuns / 50);
}
