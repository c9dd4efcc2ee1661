// The depth sensor against the vertical of the position: sign, scale, unit and delay, each where the motion shows it.
#include <doctest/doctest.h>

#include "test/support/consistency.hpp"

namespace fathom {
namespace {

using test::find;
using test::SyntheticOptions;

std::vector<ConsistencyFinding> depth_of(const Recording& recording) {
  std::vector<ConsistencyFinding> ignored;
  const estimation::RunSignals run = estimation::read_signals(recording, ignored);
  auto findings = consistency::compare_depth(run, run.pose);
  test::print(findings);
  return findings;
}

std::vector<ConsistencyFinding> depth_of(SyntheticOptions options) {
  options.duration = 120.0;
  return depth_of(test::synthetic_recording(options));
}

}  // namespace

TEST_CASE("depth: a good sensor gives no finding, wherever its water line is") {
  CHECK(depth_of({.seed = 24}).empty());
  Recording recording = test::synthetic_recording({.seed = 24, .duration = 120.0});
  for (Depth& one : recording.depth) one.z += 25.0;
  CHECK(depth_of(recording).empty());
}

TEST_CASE("depth: sign, scale, unit and delay are told apart") {
  const auto both = depth_of({.seed = 25, .depth_scale = -1.0, .depth_delay = 0.4});
  REQUIRE(find(both, "depth", "sign") != nullptr);
  REQUIRE(find(both, "depth", "delay") != nullptr);
  CHECK(find(both, "depth", "delay")->size == doctest::Approx(0.4).epsilon(0.15));
  CHECK(both.size() == 2);
  const auto scaled = depth_of({.seed = 26, .depth_scale = 0.9});
  REQUIRE(find(scaled, "depth", "scale") != nullptr);
  CHECK(find(scaled, "depth", "scale")->size == doctest::Approx(1.0 / 0.9).epsilon(0.02));
  CHECK(scaled.size() == 1);
  const auto feet = depth_of({.seed = 27, .depth_scale = 3.28084});
  REQUIRE(find(feet, "depth", "unit") != nullptr);
  CHECK(feet.size() == 1);
}

TEST_CASE("depth: a vehicle that stays at its depth says nothing about the sensor") {
  CHECK(depth_of({.seed = 28, .activity = {1, 1, 0, 1, 1, 1}, .depth_scale = -3.0, .depth_delay = 0.5}).empty());
  Recording few = test::synthetic_recording({.seed = 28, .duration = 120.0, .depth_scale = -1.0});
  few.depth.resize(60);
  CHECK(depth_of(few).empty());
}

TEST_CASE("depth: the whole sensor check hears of it") {
  const Recording recording = test::synthetic_recording({.seed = 25, .duration = 120.0, .depth_scale = -1.0});
  CHECK(find(consistency::check_consistency(std::span(&recording, 1)).findings, "depth", "sign") != nullptr);
}

}  // namespace fathom
