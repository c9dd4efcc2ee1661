// What was learned is told only where runs that judge are foretold no worse with it.
#include <doctest/doctest.h>

#include <cmath>

#include "common/verdict/by_likelihood.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

namespace {

constexpr double kCaught = 40.0;  // s, on each run's own clock

/// From a moment on the hull drags more sideways.
Vector6d caught(double t, const Vector6d& nu) {
  Vector6d nu_dot = Vector6d::Zero();
  if (t > kCaught) nu_dot[1] = -(0.6 + 2.0 * std::abs(nu[1])) * nu[1];
  return nu_dot;
}

verdict::Answer judged_by(const test::NoisyDive& judge) {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto train = test::fly(vehicle, {.duration = 120.0, .seed = 4, .force = 0.005, .outside = caught});
  const auto validate = test::fly(vehicle, judge);
  return verdict::diagnose(vehicle, {&train.trial, 1}, {&validate.trial, 1}, {}, {});
}

}  // namespace

TEST_CASE("learned on judges: what sets in at the same time in another run does not harm there") {
  const auto answer = judged_by({.duration = 90.0, .seed = 9, .force = 0.005, .outside = caught});
  REQUIRE(answer.report.result.correction);
  CHECK(answer.report.result.correction->asked);
  CHECK(answer.report.result.correction->refused.find("runs that judge") == std::string::npos);
}

TEST_CASE("learned on judges: where it is not so, nothing of it is told, the error stays, and why is said") {
  const auto answer = judged_by({.duration = 90.0, .seed = 9, .force = 0.005});
  const DiagnosisResult& result = answer.report.result;
  REQUIRE(result.correction);
  CHECK(result.correction->asked);
  CHECK_FALSE(result.correction->adopted);
  CHECK_FALSE(result.correction->carried);
  CHECK_MESSAGE(result.correction->refused.find("runs that judge") != std::string::npos, result.correction->refused);
  CHECK_FALSE(result.improvement.value < 0.0);
}
