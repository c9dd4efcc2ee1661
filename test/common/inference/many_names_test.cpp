// A craft that lacks many listed effects at once: all are named, beyond the few that imitate what no list holds.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/inference/infer.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

TEST_CASE("many names: five effects that act at once are all named, and four of them are no answer") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = test::fly(
      vehicle, {.duration = 120.0,
                .seed = 11,
                .force = 0.03,
                .effects = {test::active("current", {0.12, -0.06}), test::active("thruster_gain", {-0.35}, 0),
                            test::active("thruster_lag", {0.25}), test::active("payload_change", {1.5, 16.0, 55.0}),
                            test::active("asymmetric_drag", {40.0, 0.0}, 0)}});
  const Conclusion conclusion = infer(vehicle, {&dive.trial, 1}, {}, {});
  CHECK(conclusion.verdict == Verdict::effect);
  CHECK(conclusion.found.best.names ==
        std::vector<std::string>{"asymmetric_drag", "current", "payload_change", "thruster_gain", "thruster_lag"});
  REQUIRE(conclusion.found.fewer.size() == 1);
  CHECK(claims(conclusion.found.fewer.front().best.fit.hypothesis.model.effects) <= 4);
  REQUIRE(conclusion.found.fewer.front().free_force);
  CHECK(conclusion.found.fewer.front().free_force->log_odds > Thresholds{}.free_force_odds);
}
