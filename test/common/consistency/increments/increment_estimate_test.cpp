// Numbers read from an increment fit are as sure as they say: on data that shows them all the time, and on data that
// shows them once.
#include "common/consistency/increments/increment_estimate.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/base/distributions.hpp"
#include "common/base/statistics.hpp"

namespace fathom::consistency {
namespace {

constexpr double kStep = 0.1;    // s
constexpr int kSamples = 600;    // a minute: eight blocks
constexpr int kCount = 9;        // samples per window
constexpr double kNoise = 0.01;  // of a window
constexpr unsigned kSeeds = 200;
constexpr double kByChance = 1e-3;

/// The first axis moves all the time, or once, on both sides of a border between blocks (45 s).
Eigen::Vector3d signal(double t, bool once) {
  const double first = std::sin(0.9 * t) + 0.4 * std::sin(2.3 * t);
  return {once ? (t > 42.5 && t < 47.5 ? first : 0.0) : first, std::cos(0.7 * t) + 0.3 * std::sin(2.9 * t),
          std::sin(1.3 * t + 1.0)};
}

IncrementFit fit_of(bool once, unsigned seed, double late = 0.0) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal{0.0, kNoise};
  IncrementProblem problem;
  problem.step = kStep;
  for (int i = 0; i < kSamples; ++i) problem.t.push_back(i * kStep);
  const std::vector<double> weight = quadrature_weights(problem.t.data(), kCount);
  for (int first = 0; first + kCount <= kSamples; first += 4) {
    IncrementProblem::Window window{first, kCount, static_cast<int>(problem.basis.size())};
    Eigen::Vector3d y{normal(random), normal(random), normal(random)};
    for (int s = 0; s < kCount; ++s) {
      const double w = weight[static_cast<std::size_t>(s)];
      problem.basis.emplace_back(w * Eigen::Matrix3d::Identity());
      y += w * signal((first + s) * kStep, once);
    }
    problem.windows.push_back(window);
    problem.y.push_back(y);
    problem.fixed.emplace_back(3, 0);
  }
  Series sensor;
  for (double t = -2.0; t < kSamples * kStep + 2.0; t += 0.5 * kStep) {
    sensor.t.push_back(t);
    sensor.x.push_back(signal(t - late, once));
  }
  return fit_increments(problem, sensor, {.search_delay = late > 0.0});
}

double scale(const Eigen::VectorXd& theta) { return theta[0]; }

struct Tally {
  double square{};  // mean of ((value - truth) / sigma)^2
  int beyond{};     // further than chance allows with the degrees of freedom that are stated
  int jackknife{};  // the same of the jackknife alone with all its blocks
};

Tally tally(bool once) {
  Tally tally;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const IncrementFit fit = fit_of(once, seed);
    REQUIRE(fit.ok);
    const Estimate said = estimate(fit, scale, false);
    const double off = (said.value - 1.0) / said.sigma;
    tally.square += off * off / kSeeds;
    tally.beyond += off * off > f_quantile(kByChance, said.freedom) ? 1 : 0;
    std::vector<double> replicates;
    for (const Eigen::VectorXd& theta : fit.theta_replicates) replicates.push_back(scale(theta));
    const double alone = (said.value - 1.0) / jackknife_sigma(replicates);
    const auto freedom = static_cast<double>(replicates.size() - 1);
    tally.jackknife += alone * alone > f_quantile(kByChance, freedom) ? 1 : 0;
  }
  return tally;
}

}  // namespace

TEST_CASE("increment estimate: sigma and degrees of freedom hold over many seeds, shown always or once") {
  const Tally always = tally(false), once = tally(true);
  CHECK(always.beyond <= 2);  // 0.2 expected
  CHECK(once.beyond <= 2);
  CHECK(once.jackknife > 4);  // why the jackknife alone is not asked
  // Never much too sure; the misfit's part errs on the wide side.
  CHECK(always.square < 1.2);
  CHECK(once.square < 1.5);
  CHECK(always.square > 0.4);
}

TEST_CASE("increment estimate: what one block shows has few degrees of freedom, what all show has many") {
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(9, 0);
  CHECK(uncertainty(fit_of(true, 1), unit).blocks < 3.0);
  CHECK(uncertainty(fit_of(false, 1), unit).blocks > 6.0);
  CHECK(estimate(fit_of(true, 1), scale, false).freedom < estimate(fit_of(false, 1), scale, false).freedom);
}

TEST_CASE("increment estimate: a delay is as sure as it says") {
  constexpr double kLate = 0.13;  // s
  double square = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const IncrementFit fit = fit_of(false, seed, kLate);
    const Estimate said = estimate_delay(fit);
    square += std::pow((said.value - kLate) / said.sigma, 2) / kSeeds;
  }
  CHECK(square < 1.3);
  CHECK(square > 0.3);
}

}  // namespace fathom::consistency
