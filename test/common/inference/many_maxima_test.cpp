// What ends in the wrong place unless it is sought from several: delays that clocks would swallow, moments of events,
// forms of one effect; and what an effect does where base numbers seem to do it too.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/inference/infer.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

likelihood::Fit base_fit(const likelihood::Problem& problem) {
  return likelihood::fit(problem, likelihood::nominal_hypothesis(problem), likelihood::prior_noise(problem), {});
}

const Law& law_of(const std::vector<Law>& laws, const std::string& name, const std::string& form = {}) {
  const auto found = std::ranges::find_if(
      laws, [&](const Law& law) { return law.name == name && (form.empty() || law.form == form); });
  REQUIRE(found != laws.end());
  return *found;
}

}  // namespace

TEST_CASE("many maxima: thrust that acts later than clocks leave open has a name") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle, {.duration = 90.0, .seed = 5, .force = 0.03, .effects = {test::active("thruster_delay", {0.06, 0.0})}});
  const Conclusion conclusion = infer(vehicle, {&dive.trial, 1}, {}, {});
  CHECK(conclusion.verdict == Verdict::effect);
  REQUIRE(conclusion.found.best.names == std::vector<std::string>{"thruster_delay"});
  const likelihood::Hypothesis& best = conclusion.found.best.fit.hypothesis;
  // The clock's share is part of the whole.
  CHECK(best.model.effects[0].theta[0] + best.runs[0].command_offset == doctest::Approx(0.06).epsilon(0.05));
  CHECK(std::abs(best.runs[0].command_offset) < 0.021);  // two deviations of 5 ms and half a step of 20 ms
}

TEST_CASE("many maxima: among the places from which an event is fitted once more is its moment") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle,
      {.duration = 90.0, .seed = 6, .force = 0.05, .effects = {test::active("payload_change", {0.5, 6.0, 61.0})}});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  const Law& payload = law_of(laws, "payload_change");
  REQUIRE(shaped(payload));
  REQUIRE(payload.onset >= 0);
  const auto starts = starts_of(problem, see(problem, base_fit(problem), 1), payload, 3, {}, 1);
  REQUIRE(!starts.empty());
  CHECK(starts.size() <= 3);
  const auto at = static_cast<std::size_t>(payload.onset);
  CHECK(std::ranges::any_of(starts, [&](const auto& theta) { return std::abs(theta[at] - 61.0) < 1.0; }));
}

TEST_CASE("many maxima: a coupling of inertias has its size, though base numbers move the same axes through it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 60.0, .seed = 7, .force = 0.02});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  likelihood::Fit fit = base_fit(problem);
  model::ActiveEffect coupling = law_of(laws, "cross_coupling", "Y_r_dot").seed;
  std::ranges::fill(coupling.theta, 0.0);
  coupling.theta[0] = 0.1 * vehicle.inertia[2];  // kg m: a tenth of a metre off, for each kg m^2
  fit.hypothesis.model.add(coupling);
  fit.numbers = problem.numbers(fit.hypothesis);
  const Seen seen = see(problem, fit, 1);
  // Turning by it: coupling * v_dot / I_z over the turning that is applied.
  double pushed = 0.0, count = 0.0;
  for (const auto& reference : seen.reference) {
    pushed += reference.nu_dot.row(1).squaredNorm();
    count += static_cast<double>(reference.nu_dot.cols());
  }
  const double expected = 0.1 * std::sqrt(pushed / count) / seen.applied[5];
  CHECK(size_of_effect(problem, seen, 0).share > 0.5 * expected);
}

TEST_CASE(
    "many maxima: what was refused for a limit is no rival of what was found, and what is too small to matter is") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 30.0, .force = 0.05});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  FittedModels models{problem, laws, 1, {}};
  const auto fitted = [&](const char* name, double log_evidence, const char* beside = "") {
    likelihood::Fit fit;
    fit.hypothesis = likelihood::nominal_hypothesis(problem);
    for (const char* each : {name, beside})
      if (*each != '\0') fit.hypothesis.model.add(law_of(laws, each).seed);
    fit.log_evidence = log_evidence;
    fit.finite = true;
    return models.add(std::move(fit));
  };
  const Fitted base = fitted("", 0.0), found = fitted("current", 100.0);
  fitted("wave", 95.0);
  fitted("thruster_lag", 2000.0);  // taken by nobody
  const Standing standing = models.standing(found, base.score, "current", {});
  CHECK(standing.rival == "wave");
  CHECK(standing.probability > 0.9);
  CHECK(standing.probability < 1.0);
  const Standing beside_small = models.standing(found, base.score, "current", {{"thruster_lag"}});
  CHECK(beside_small.rival == "thruster_lag");
  CHECK(beside_small.probability < 0.1);
  // Small beside the name, and thousands of nats above it: the name is as sure as ever.
  fitted("current", 5000.0, "centre_of_mass");
  const Standing with_small =
      models.standing(found, base.score, "current", {{"centre_of_mass", "current"}, {"thruster_lag"}});
  CHECK(with_small.probability == doctest::Approx(1.0));
}

TEST_CASE("many maxima: forms that act in place of each other do not stand in one model, others do") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 20.0});
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  const auto seed = [&](const char* name, const char* form) { return law_of(laws, name, form).seed; };
  CHECK(exclude(seed("thruster_delay", ""), seed("thruster_delay", "vertical thrusters apart")));
  CHECK(exclude(seed("thruster_lag", ""), seed("thruster_lag", "second order")));
  CHECK_FALSE(exclude(seed("cross_coupling", "X_r"), seed("cross_coupling", "X_w")));
  CHECK_FALSE(exclude(seed("thruster_delay", ""), seed("thruster_lag", "")));
}
