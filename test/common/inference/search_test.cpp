#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>

#include "common/inference/infer.hpp"
#include "common/model/rollout.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

/// A conclusion refers to its vehicle.
Conclusion inferred(const model::Vehicle& vehicle, const test::NoisyDive& settings,
                    const std::vector<std::string>& without = {}) {
  const auto dive = test::fly(vehicle, settings);
  const auto begin = std::chrono::steady_clock::now();
  const Conclusion conclusion =
      infer(vehicle, {&dive.trial, 1}, {.without = without}, Progress{[&](const Progress::Event& event) {
              if (std::getenv("FATHOM_SHOW") == nullptr || event.kind != Progress::Event::Kind::kBegin) return;
              std::printf("%6.2f %s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
                          std::string{event.what}.c_str());
            }});
  if (std::getenv("FATHOM_SHOW") != nullptr) {
    std::printf("%6.2f verdict %s, fits %zu\n",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
                std::string(word(conclusion.verdict)).c_str(), conclusion.found.fits);
    for (const Reason& reason : conclusion.reasons)
      std::printf("  %s %.3g (%.3g) %s\n", std::string(word(reason.cause)).c_str(), reason.value, reason.threshold,
                  reason.of.c_str());
    for (std::size_t e = 0; e < conclusion.found.odds.size(); ++e) {
      const auto& active = conclusion.found.best.fit.hypothesis.model.effects[e];
      std::printf("  effect %s %s odds %.1f size %.4f p %.3f rival %s:", std::string(active.effect->name()).c_str(),
                  active.variant_name.c_str(), conclusion.found.odds[e], conclusion.found.size[e],
                  conclusion.found.probability[e], conclusion.found.rival[e].c_str());
      for (double x : active.theta) std::printf(" %.4g", x);
      std::printf("\n");
    }
    for (std::size_t k = 0; k < std::min<std::size_t>(5, conclusion.found.refused.size()); ++k)
      std::printf("  refused %s %s promised %.1f: %s %.2f\n", conclusion.found.refused[k].name.c_str(),
                  conclusion.found.refused[k].form.c_str(), conclusion.found.refused[k].promised,
                  std::string(word(conclusion.found.refused[k].refusals[0].rule)).c_str(),
                  conclusion.found.refused[k].refusals[0].value);
    if (conclusion.found.free_force) {
      std::printf("  free force %.1f (fixed noise %.1f) size %.4f axis %d:", conclusion.found.free_force->log_odds,
                  conclusion.found.free_force->at_fixed_noise, conclusion.found.free_force->size.share,
                  conclusion.found.free_force->size.axis);
      for (const auto& g : conclusion.found.free_force->groups) std::printf(" [%s %.1f]", words(g).c_str(), g.gain);
      std::printf("\n");
    }
    for (const RandomForce& force : conclusion.random)
      std::printf("  random %d sigma %.4f memory %.2f share %.4f\n", force.axis, force.sigma, force.memory,
                  force.share);
  }
  return conclusion;
}

Conclusion inferred(const test::NoisyDive& settings, const std::vector<std::string>& without = {},
                    const char* craft = "bluerov2") {
  static std::map<std::string, model::Vehicle> vehicles;
  return inferred(vehicles.try_emplace(craft, test::vehicle_from_repository(craft)).first->second, settings, without);
}

}  // namespace

TEST_CASE("search: nothing is found where only a random force acts") {
  CHECK(inferred({.duration = 90.0, .seed = 3, .force = 0.05}).verdict == Verdict::adequate);
}

TEST_CASE("search: one effect beside a random force is named") {
  const Conclusion current =
      inferred({.duration = 90.0, .seed = 4, .force = 0.05, .effects = {test::active("current", {0.1, 0.05})}});
  CHECK(current.verdict == Verdict::effect);
  CHECK(current.found.best.names == std::vector<std::string>{"current"});
}

TEST_CASE("search: a stream that turns within the run is a current, with its moment and how long it takes") {
  std::vector<double> turns(model::find_effect("current")->parameters().size(), 0.0);
  const auto place = [](std::string_view name) {
    const auto all = model::find_effect("current")->parameters();
    return static_cast<std::size_t>(std::ranges::find(all, name, &model::EffectParameter::name) - all.begin());
  };
  turns[place("v_N")] = 0.1;
  turns[place("v_N_2")] = -0.1;
  turns[place("v_E_2")] = 0.05;
  turns[place("onset")] = 60.0;
  turns[place("duration")] = 30.0;
  const Conclusion found =
      inferred({.duration = 120.0, .seed = 5, .force = 0.05, .effects = {test::active("current", turns, 2)}});
  CHECK(found.verdict == Verdict::effect);
  REQUIRE(found.found.best.names == std::vector<std::string>{"current"});
  const model::ActiveEffect& current = found.found.best.fit.hypothesis.model.effects.front();
  CHECK(current.variant_name == "turning");
  CHECK(current.theta[place("v_N_2")] == doctest::Approx(-0.1).epsilon(0.1));
  CHECK(current.theta[place("onset")] == doctest::Approx(60.0).epsilon(0.03));
}

TEST_CASE("search: what a boat's flow does by nature is found whole, and takes no place among the names") {
  const model::Vehicle boat = test::vehicle_from_repository("blueboat");
  model::Scene scene{.vehicle = &boat};
  scene.nu_rms.setConstant(0.3);
  const model::Effect& lift = *model::find_effect("body_lift");
  const auto forms = lift.variants(scene);
  const auto sideways = static_cast<int>(std::ranges::find(forms, "hull, sideways") - forms.begin());
  std::vector<double> surfaces(lift.parameters().size(), 0.0);
  // Two hulls of low aspect, their lift aft of the middle; half of the suction is left.
  surfaces[1] = 31.0, surfaces[2] = -8.0, surfaces[3] = 4.6, surfaces[4] = 0.5;
  const Conclusion found = inferred(
      {.duration = 240.0,
       .seed = 6,
       .force = 0.01,
       .effects = {test::active("body_lift", surfaces, sideways), test::active("cross_flow", {96.0, 0.0, 1.195}, 0)}},
      {}, "blueboat");
  CHECK(found.verdict == Verdict::effect);
  REQUIRE(found.found.best.names == std::vector<std::string>{"body_lift", "cross_flow"});
  const auto& effects = found.found.best.fit.hypothesis.model.effects;
  CHECK(claims(effects) == 0);
  CHECK(effects[0].theta[1] == doctest::Approx(31.0).epsilon(0.1));
  CHECK(effects[0].theta[4] == doctest::Approx(0.5).epsilon(0.2));
  CHECK(effects[1].theta[0] == doctest::Approx(96.0).epsilon(0.2));
}

TEST_CASE("search: what was published of a ship is found as a share of it, and takes no place among the names") {
  const model::Vehicle ship = test::vehicle_from_repository("kvlcc2_l3");
  const model::Effect& lift = *model::find_effect("body_lift");
  std::vector<double> published(lift.parameters().size(), 0.0);
  published.back() = 0.9;
  const int form = lift.form_count() - 1;
  const Conclusion found =
      inferred({.duration = 240.0, .seed = 9, .force = 0.002, .effects = {test::active("body_lift", published, form)}},
               {}, "kvlcc2_l3");
  CHECK(found.verdict == Verdict::effect);
  REQUIRE_FALSE(found.found.best.names.empty());
  const auto& effects = found.found.best.fit.hypothesis.model.effects;
  CHECK(claims(effects) == 0);
  REQUIRE(effects[0].variant_name == "as published: mmg_3");
  CHECK(effects[0].theta.back() == doctest::Approx(0.9).epsilon(0.1));
}

TEST_CASE("search: a thruster whose jet crosses another's is told from thrusters that are weak") {
  model::Vehicle crossed = test::vehicle_from_repository("bluerov2");
  const model::Thruster& blows = crossed.thrusters[0];
  model::Thruster& blown_at = crossed.thrusters[2];
  blown_at.p_BJ = blows.p_BJ - 0.3 * blows.axis_B;
  crossed.allocation.col(2) << blown_at.axis_B, blown_at.p_BJ.cross(blown_at.axis_B);
  const model::Effect& wake = *model::find_effect("thruster_wake");
  const auto forms = wake.variants({.vehicle = &crossed});
  const std::string pair = blown_at.name + " in the jet of " + blows.name;
  const auto form = static_cast<int>(std::ranges::find(forms, pair) - forms.begin());
  const Conclusion found = inferred(
      crossed, {.duration = 90.0, .seed = 8, .force = 0.05, .effects = {test::active("thruster_wake", {0.3}, form)}});
  CHECK(found.verdict == Verdict::effect);
  REQUIRE(found.found.best.names == std::vector<std::string>{"thruster_wake"});
  const model::ActiveEffect& named = found.found.best.fit.hypothesis.model.effects.front();
  CHECK(named.variant_name == pair);
  CHECK(named.theta[0] == doctest::Approx(0.3).epsilon(0.15));
}

TEST_CASE("free force: it finds what no list holds, says what it goes with, and nothing where nothing is") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto found_in = [&](const test::NoisyDive& settings) {
    const auto dive = test::fly(vehicle, settings);
    const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
    const likelihood::Fit base = likelihood::fit(problem, likelihood::nominal_hypothesis(problem),
                                                 likelihood::prior_noise(problem), {.noise_rounds = 4});
    return find_free_force(problem, see(problem, base, 1), model::scene_of(vehicle, {&dive.trial, 1}), {}, 1);
  };
  const FreeForceFound nothing = found_in({.duration = 60.0, .seed = 3, .force = 0.05});
  CHECK(nothing.log_odds < Thresholds{}.free_force_odds);
  const FreeForceFound law =
      found_in({.duration = 60.0, .seed = 3, .force = 0.05, .outside = [](double, const Vector6d& nu) {
                  return Vector6d{0.0, 1.5 * nu[0] * std::abs(nu[0]), 0.0, 0.0, 0.0, 0.0};
                }});
  CHECK(law.log_odds > Thresholds{}.free_force_odds);
  CHECK(law.size.share > Thresholds{}.smallest_size);
  CHECK(words(law.groups.front()) == "velocity in Y");
}

TEST_CASE("scan: what the score test promises is what a full fit gains") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle, {.duration = 60.0, .seed = 6, .force = 0.05, .effects = {test::active("current", {0.03, 0.0})}});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const likelihood::Fit base =
      likelihood::fit(problem, likelihood::nominal_hypothesis(problem), likelihood::prior_noise(problem), {});
  const Seen seen = see(problem, base, 1);
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  const Scan found = scan(problem, seen, laws, {}, 1);
  REQUIRE(laws[found.promises.front().law].name == "current");
  likelihood::Hypothesis with = base.hypothesis;
  model::ActiveEffect active = laws[found.promises.front().law].seed;
  active.theta = found.promises.front().theta;
  CHECK(active.theta[0] == doctest::Approx(0.03).epsilon(0.2));
  with.model.add(active);
  // Noise as the base model has it: the score knows no other.
  const likelihood::Fit full =
      likelihood::fit(problem, with, base.noise, {.noise_rounds = 1, .steps = 6, .fit_noise = false});
  CHECK(full.log_evidence - base.log_evidence == doctest::Approx(found.promises.front().score).epsilon(0.15));
}

TEST_CASE("scan: under another noise promises are those of numbers that have moved to where it wants them") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle, {.duration = 60.0, .seed = 6, .force = 0.05, .effects = {test::active("current", {0.1, 0.05})}});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  likelihood::Fit quiet =
      likelihood::fit(problem, likelihood::nominal_hypothesis(problem), likelihood::prior_noise(problem), {});
  for (likelihood::AxisNoise& axis : quiet.noise) axis.log[likelihood::kForce] -= std::log(5.0);
  const likelihood::Fit moved =
      likelihood::fit(problem, quiet.hypothesis, quiet.noise, {.noise_rounds = 1, .steps = 6, .fit_noise = false});
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  const auto promised = [&](const likelihood::Fit& fit, std::string_view name) {
    for (const Promise& promise : scan(problem, see(problem, fit, 1), laws, {}, 1).promises)
      if (laws[promise.law].name == name) return promise.score;
    return 0.0;
  };
  // A payload is what the model's own masses can nearly do.
  for (const char* name : {"current", "payload_change"}) {
    CAPTURE(name);
    const double before = promised(quiet, name), after = promised(moved, name);
    CHECK(std::abs(before - after) < 0.2 * std::abs(after) + 10.0);
  }
}

TEST_CASE("search: spikes, heavy tails and a scale that varies give no name") {
  const Conclusion noisy =
      inferred({.duration = 90.0, .seed = 8, .force = 0.03, .sensor_factor = [](double t, std::mt19937& random) {
                  const double tail = std::sqrt(3.0 / std::chi_squared_distribution<double>{3.0}(random));
                  const double spike = std::uniform_real_distribution<double>{}(random) < 0.003 ? 50.0 : 1.0;
                  return tail * spike * (std::fmod(t, 30.0) < 10.0 ? 3.0 : 1.0);
                }});
  CHECK(noisy.verdict == Verdict::adequate);
  CHECK(noisy.found.best.names.empty());
}

TEST_CASE("infer: a run of a few seconds is not judged, and says how much is needed") {
  const Conclusion brief = inferred({.duration = 5.0});
  CHECK(brief.verdict == Verdict::not_judged);
  REQUIRE(brief.reasons.size() == 1);
  CHECK(brief.reasons[0].cause == Cause::kTooShort);
  CHECK(brief.reasons[0].threshold == Thresholds{}.shortest);
}
