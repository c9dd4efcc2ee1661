// Whether a name's own law holds: right laws have nothing to gain by going with something else, wrong ones have.
#include "common/inference/own_law.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "common/inference/catalogue.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

struct Asked {
  Modulation modulation;
  double theta{};  ///< first number of the name that was fitted
};

/// A dive in which `acts` is at work, explained by `name`.
Asked asked(const model::ActiveEffect& acts, const std::string& name, const std::string& form) {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 120.0, .seed = 3, .force = 0.03, .effects = {acts}});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const model::Scene scene = model::scene_of(vehicle, {&dive.trial, 1});
  const std::vector<Law> laws = catalogue(scene, {});
  const auto law = std::ranges::find_if(laws, [&](const Law& one) { return one.name == name && one.form == form; });
  REQUIRE(law != laws.end());
  likelihood::Hypothesis hypothesis = likelihood::nominal_hypothesis(problem);
  hypothesis.model.add(law->seed);
  const likelihood::Fit fit = likelihood::fit(problem, hypothesis, likelihood::prior_noise(problem), {});
  REQUIRE(fit.finite);
  return {modulation_of(problem, see(problem, fit, 1), scene, 0, {}), fit.hypothesis.model.effects[0].theta[0]};
}

}  // namespace

TEST_CASE("own law: a thruster that is weak all the time is so wherever the craft goes") {
  const Asked weak = asked(test::active("thruster_gain", {-0.4}, 0), "thruster_gain", "front_starboard");
  CHECK(weak.theta == doctest::Approx(-0.4).epsilon(0.05));
  // What chance leaves: a tenth of its strength at most.
  CHECK(weak.modulation.depth < 0.1);
}

TEST_CASE("own law: a thruster that fails halfway is none that is weak: its strength changes") {
  const Asked failed = asked(test::active("thruster_failure", {0.4, 60.0}, 0), "thruster_gain", "front_starboard");
  CHECK(failed.theta < -0.1);
  CHECK(failed.modulation.depth > 0.4);
  CHECK(failed.modulation.nats > 20.0);
}
