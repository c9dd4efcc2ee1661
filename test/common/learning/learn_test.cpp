#include "common/learning/learn.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

#include "test/common/learning/learned_case.hpp"

using namespace fathom;
using namespace fathom::learning;
using test::bluerov;
using Case = test::LearnedCase;
using test::show;

namespace {

Vector6d cross_drag(double, const Vector6d& nu) { return {0.0, 0.4 * nu[0] * std::abs(nu[0]), 0.0, 0.0, 0.0, 0.0}; }

}  // namespace

TEST_CASE("learning: an unlisted force is adopted, and what was not recorded yet is foretold better by it") {
  const Case sway{{.duration = 160.0, .seed = 3, .force = 0.01, .outside = cross_drag}, true, 0.5};
  const Learned learned = sway.learned();
  show("cross drag", learned.given);
  REQUIRE(learned.given.adopted);
  REQUIRE(learned.given.carried);
  REQUIRE(learned.given.formula);
  CHECK(learned.given.formula->equation == "tau_Y = c sign(u) |u|^n");
  REQUIRE(learned.given.formula->numbers.size() == 2);
  const NamedValue& power = learned.given.formula->numbers[1];
  CHECK(std::abs(power.value - 2.0) < 0.3);
  const double step = sway.problem.input_step;
  const model::Model better = as_model(learned.fit.hypothesis, step, learned.elsewhere.get());
  const residual::Ratio over_base = residual::error_over(as_model(sway.conclusion.found.best.fit.hypothesis, step),
                                                         better, {&sway.rest, 1}, residual::OpenLoop{});
  // The law itself, told and fitted to the same half.
  likelihood::Hypothesis told = sway.conclusion.found.best.fit.hypothesis;
  model::Feature law{.axis = 1, .count = 2, .scale = 20.0};
  law.factors[0] = {.quantity = model::Quantity::kVelocity, .index = 0};
  law.factors[1] = {.quantity = model::Quantity::kSpeed, .index = 0};
  told.force = {.features = {law}, .groups = {{.kind = "told", .axis = 1, .count = 1, .sigma = 1.0}}, .weights = {0.0}};
  const likelihood::Fit fit =
      likelihood::fit(sway.problem, told, learned.fit.noise, {.noise_rounds = 2, .steps = 3, .threads = 2});
  const model::LearnedForce exact{fit.hypothesis.force, visited_by(sway.problem, fit.hypothesis),
                                  fit.hypothesis.model.allocation};
  const residual::Ratio over_told =
      residual::error_over(as_model(fit.hypothesis, step, &exact), better, {&sway.rest, 1}, residual::OpenLoop{});
  if (std::getenv("FATHOM_SHOW") != nullptr)
    std::printf("  second half: %.4f of base, %.4f of told\n", over_base.value, over_told.value);
  CHECK(over_base.value < 0.75);
  CHECK(over_told.value < 1.3);
}

TEST_CASE("learning: where nothing is hidden, or a random force acts alone, nothing is adopted") {
  for (const double force : {0.0, 0.1}) {
    const Case clean{{.duration = 60.0, .seed = 5, .force = force}};
    const Learned learned = clean.learned();
    show("nothing hidden", learned.given);
    CHECK_FALSE(learned.given.adopted);
    CHECK_FALSE(learned.given.refused.empty());
    CHECK(learned.here == nullptr);
  }
}

TEST_CASE("learning: weights that only fit the random force are refused, whatever their odds") {
  Case noisy{{.duration = 60.0, .seed = 6, .force = 0.2, .force_memory = 3.0}, false};
  likelihood::Hypothesis with = noisy.conclusion.found.best.fit.hypothesis;
  constexpr int kSteps = 40;
  for (int j = 0; j < kSteps; ++j) {
    model::Feature step{.axis = 0, .count = 1, .scale = 10.0};
    step.factors[0] = {.quantity = model::Quantity::kAfter, .a = 60.0 * j / kSteps, .b = 1.5};
    with.force.features.push_back(step);
    with.force.weights.push_back(0.0);
  }
  with.force.groups.push_back({.kind = "time", .axis = 0, .first = 0, .count = kSteps, .sigma = 1.0});
  likelihood::Noise noise = noisy.conclusion.found.best.fit.noise;
  for (likelihood::AxisNoise& axis : noise) axis.log[likelihood::kForce] -= std::log(10.0);
  inference::FreeForceFound found{.groups = {{"time", 0, 100.0}}, .log_odds = 653.0, .size = {0.1, 0}};
  found.fit =
      likelihood::fit(noisy.problem, with, noise, {.noise_rounds = 1, .steps = 2, .fit_noise = false, .threads = 2});
  REQUIRE(found.fit.finite);
  noisy.conclusion.found.free_force = found;
  const Learned learned = noisy.learned();
  show("overfit", learned.given);
  CHECK_FALSE(learned.given.adopted);
  CHECK(learned.given.held_out > 1.0);
}
