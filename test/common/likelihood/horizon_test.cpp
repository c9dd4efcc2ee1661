// The multi-horizon score: what is hidden moves nothing, and numbers that it chooses predict far ahead.
#include <doctest/doctest.h>

#include <cmath>

#include "common/likelihood/fit.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

namespace {

/// `noise`: stated, since what a trial shows of it changes with its samples.
PassResult passed(const model::Vehicle& vehicle, const Trial& trial, const Noise& noise, const PassOptions& options,
                  Reference& reference) {
  const Problem problem = make_problem(vehicle, {&trial, 1});
  const Hypothesis hypothesis = nominal_hypothesis(problem);
  return pass(problem, hypothesis, problem.numbers(hypothesis), noise, options, &reference);
}

/// Rms over axes and hidden samples of the whitened innovations' numerators: the error far ahead.
double hidden_error(const Problem& problem, const Fit& fit) {
  Reference reference;
  PassOptions options{.derivatives = false, .horizon = Horizon{}};
  (void)pass(problem, fit.hypothesis, fit.numbers, fit.noise, options, &reference);
  double square = 0.0, count = 0.0;
  const auto& blocks = problem.runs[0].blocks();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (reference[0].information.col(static_cast<Eigen::Index>(b)).maxCoeff() == 0.0) continue;
    const Vector6d off = blocks[b].y - reference[0].trace.col(static_cast<Eigen::Index>(blocks[b].last));
    for (const int axis : problem.axes) square += axis < 2 ? off[axis] * off[axis] : 0.0;
    count += 1.0;
  }
  return std::sqrt(square / count);
}

}  // namespace

TEST_CASE("horizon: samples are hidden for ten of every fifteen seconds, and each is scored by itself") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  auto dive = test::fly(vehicle, {.duration = 46.0, .force = 0.05});
  const Horizon horizon{.lead = 5.0, .hidden = 10.0};
  Reference before, after;
  const Noise noise = prior_noise(make_problem(vehicle, {&dive.trial, 1}));
  const PassResult whole = passed(vehicle, dive.trial, noise, {}, before);
  const PassResult part = passed(vehicle, dive.trial, noise, {.horizon = horizon}, before);
  // 46 s less 2 s of burn-in; hidden are 30 s of it.
  CHECK(part.scored == doctest::Approx(whole.scored * 30.0 / 44.0).epsilon(0.01));
  // A hidden sample that is another moves no other innovation; one that is used moves those that follow.
  const auto moved_beside = [&](double t) {
    Trial trial = dive.trial;
    const auto k = static_cast<std::size_t>(std::lround(t / trial.dt));
    trial.nu[k][0] += 1e-3;
    (void)passed(vehicle, trial, noise, {.horizon = horizon}, after);
    double own = 0.0, others = 0.0;
    for (Eigen::Index b = 0; b < before[0].innovation.cols(); ++b) {
      const double by = (after[0].innovation.col(b) - before[0].innovation.col(b)).norm();
      const double from = trial.t[k] - 0.05, to = trial.t[k] + 0.05;
      const double at = (static_cast<double>(b) + 0.5) * 0.04;
      (at > from && at < to ? own : others) += by;
    }
    CHECK(own > 1e-3);
    return others;
  };
  CHECK(moved_beside(25.0) == 0.0);
  CHECK(moved_beside(17.0) > 1e-3);
}

TEST_CASE("horizon: where the model errs, its numbers predict ten seconds better than those of one step") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle, {.duration = 120.0, .seed = 5, .force = 0.02, .outside = [](double, const Vector6d& nu) {
                  return Vector6d{
                      -3.0 * nu[0] * nu[0] * nu[0] - 0.4 * nu[1], 0.8 * nu[0] * std::abs(nu[0]), 0.0, 0.0, 0.0, 0.0};
                }});
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  const Fit steps = fit(problem, nominal_hypothesis(problem), prior_noise(problem), {.noise_rounds = 4});
  const Fit horizons = fit(problem, steps.hypothesis, steps.noise,
                           {.noise_rounds = 1, .steps = 6, .fit_noise = false, .horizon = Horizon{}});
  REQUIRE(horizons.finite);
  MESSAGE("one step " << hidden_error(problem, steps) << " m/s, horizon " << hidden_error(problem, horizons) << " m/s");
  CHECK(hidden_error(problem, horizons) < 0.98 * hidden_error(problem, steps));
}
