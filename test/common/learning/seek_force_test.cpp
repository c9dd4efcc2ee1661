// What is sought on stretches of a long recording is what all of it has.
#include "common/learning/seek_force.hpp"

#include <doctest/doctest.h>

#include "test/common/learning/learned_case.hpp"

using namespace fathom;

namespace {

Vector6d cross_drag(double, const Vector6d& nu) { return {0.0, 0.4 * nu[0] * std::abs(nu[0]), 0.0, 0.0, 0.0, 0.0}; }

}  // namespace

TEST_CASE("seek force: on stretches of a recording, with the weights and the odds of all of it") {
  const test::LearnedCase sway{{.duration = 160.0, .seed = 3, .force = 0.01, .outside = cross_drag}, false};
  const likelihood::Fit& base = sway.conclusion.found.best.fit;
  const model::Scene scene = model::scene_of(test::bluerov(), {&sway.trial, 1});
  inference::Thresholds shorter;
  shorter.search_blocks = 0.3 * static_cast<double>(sway.problem.runs.front().blocks().size());
  const auto stretches = inference::stretches_of(sway.problem, shorter);
  REQUIRE(stretches);
  REQUIRE(2 * stretches->trials.front().size() < sway.trial.size());
  const auto sought = [&](const std::optional<inference::Stretches>& on) {
    return learning::seek_force(sway.problem, base, scene, {}, 2, {}, on).all;
  };
  const inference::FreeForceFound whole = sought(std::nullopt), few = sought(stretches);
  REQUIRE(whole.fit.finite);
  REQUIRE(few.fit.finite);
  REQUIRE_FALSE(few.groups.empty());
  CHECK(few.groups.front().kind == whole.groups.front().kind);
  CHECK(few.groups.front().axis == 1);
  // Every block of the recording stands behind it, not those of the stretches.
  CHECK(few.fit.scored == whole.fit.scored);
  CHECK(few.fit.hypothesis.runs.size() == 1);
  CHECK(few.log_odds > 0.9 * whole.log_odds);
}
