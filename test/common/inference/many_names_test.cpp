// A craft that lacks many listed effects at once: all are named, beyond the few that imitate what no list holds.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/inference/infer.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

namespace {

/// Four that act all the time, and a fifth.
test::VirtualDive dive_with(const model::Vehicle& vehicle, double duration, model::ActiveEffect fifth) {
  return test::fly(vehicle,
                   {.duration = duration,
                    .seed = 11,
                    .force = 0.03,
                    .effects = {test::active("current", {0.12, -0.06}), test::active("thruster_gain", {-0.35}, 0),
                                test::active("thruster_lag", {0.25}), test::active("thruster_misalignment", {0.3}, 1),
                                std::move(fifth)}});
}

std::string told(const Conclusion& conclusion) {
  std::string text;
  for (const std::string& name : conclusion.found.best.names) text += name + ' ';
  for (const Reason& reason : conclusion.reasons)
    text += std::string{word(reason.cause)} + ' ' + std::to_string(reason.value) + ' ' + reason.of + "; ";
  return text;
}

}  // namespace

TEST_CASE("many names: five effects that act at once are all named, and four of them are no answer") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = dive_with(vehicle, 160.0, test::active("payload_change", {2.5, 30.0, 70.0}));
  const Conclusion conclusion = infer(vehicle, {&dive.trial, 1}, {}, {});
  INFO(told(conclusion));
  CHECK(conclusion.verdict == Verdict::effect);
  CHECK(conclusion.found.best.names == std::vector<std::string>{"current", "payload_change", "thruster_gain",
                                                                "thruster_lag", "thruster_misalignment"});
  REQUIRE(conclusion.found.fewer.size() == 1);
  CHECK(claims(conclusion.found.fewer.front().best.fit.hypothesis.model.effects) <= 4);
  REQUIRE(conclusion.found.fewer.front().free_force);
  CHECK(conclusion.found.fewer.front().free_force->log_odds > Thresholds{}.free_force_odds);
}

TEST_CASE("many names: five that stretches of a long recording show are asked of all of it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = dive_with(vehicle, 240.0, test::active("asymmetric_drag", {12.0, 0.0}, 0));
  Settings settings;
  settings.thresholds.search_blocks = 2500.0;
  const Conclusion conclusion = infer(vehicle, {&dive.trial, 1}, settings, {});
  INFO(told(conclusion));
  CHECK(conclusion.verdict == Verdict::effect);
  CHECK(conclusion.found.best.names == std::vector<std::string>{"asymmetric_drag", "current", "thruster_gain",
                                                                "thruster_lag", "thruster_misalignment"});
  CHECK(conclusion.found.fewer.size() == 1);
}
