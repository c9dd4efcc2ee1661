// Corrected sensor faults take their place among the effects; what is pooled, certain and corrected, and nothing else.
#include "common/preflight/sensor_faults.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

using namespace fathom;

namespace {

ConsistencyFinding finding(const char* signal, const char* what, double size, double std) {
  return {.run = "all",
          .signal = signal,
          .reference = "pose_capture",
          .finding = what,
          .size = size,
          .action = "corrected: as said",
          .std = std};
}

}  // namespace

TEST_CASE("sensor faults: delay, scale and lever arm become effects, in the terms of the effect") {
  DiagnosisResult result{.verdict = "adequate", .paragraph = "Nothing else."};
  result.candidates.push_back({.name = "sensor_scale", .reason = "not applicable"});
  result.effects.push_back({.name = "current"});
  result.consistency = {finding("dvl", "delay", 0.2, 0.002), finding("dvl.u", "scale", 0.8, 0.01),
                        finding("dvl.v", "scale", 0.9, 0.01), finding("dvl", "lever_arm_x", 0.1, 0.01)};
  preflight::adopt_sensor_faults(result);
  REQUIRE(result.effects.size() == 4);
  CHECK(result.effects[0].name == "sensor_latency");
  CHECK(result.effects[1].name == "sensor_scale");
  CHECK(result.effects[1].variant == "dvl.u, dvl.v");
  REQUIRE(result.effects[1].parameters.size() == 2);
  CHECK(result.effects[1].parameters[0].value == doctest::Approx(0.25));
  CHECK(result.effects[1].parameters[0].std == doctest::Approx(0.01 / 0.64));
  CHECK(result.effects[2].name == "lever_arm");
  CHECK(result.effects[3].name == "current");
  CHECK(result.verdict == "effect");
  CHECK(result.candidates.size() == 3);
  CHECK(result.effects[0].log_odds > 3.0);
}

TEST_CASE("sensor faults: thrust that is as late as the gyro is on another clock, not late") {
  DiagnosisResult result;
  result.effects = {{.name = "thruster_delay", .parameters = {{"delay", 0.43, 0.011, "s"}}}};
  ConsistencyFinding clock = finding("thrusters", "clock", 0.439, 0.0);
  clock.reference = "gyro";
  std::vector<ConsistencyFinding> findings{finding("gyro", "delay", 0.439, 0.002), clock};
  CHECK(preflight::thrust_as_late_as_gyro(result, findings));
  result.effects[0].parameters[0].value = 0.39;  // four standard deviations: a delay of its own
  CHECK_FALSE(preflight::thrust_as_late_as_gyro(result, findings));
  result.effects[0].parameters[0].value = 0.43;
  findings[1].reference = "pose_capture";  // thrusters are on that clock already
  CHECK_FALSE(preflight::thrust_as_late_as_gyro(result, findings));
  findings[1].reference = "gyro";
  findings[0].size = -0.439;  // the pose is late
  CHECK_FALSE(preflight::thrust_as_late_as_gyro(result, findings));
  result.effects.clear();
  CHECK_FALSE(preflight::thrust_as_late_as_gyro(result, findings));
}

TEST_CASE("sensor faults: eight standard deviations are worth less where few blocks of data tell of them") {
  const auto odds = [](double freedom) {
    DiagnosisResult result{.verdict = "adequate"};
    result.consistency = {finding("dvl", "lever_arm_x", 0.08, 0.01)};
    result.consistency[0].freedom = freedom;
    preflight::adopt_sensor_faults(result);
    return result.effects.at(0).log_odds;
  };
  CHECK(odds(1e6) == doctest::Approx(32.0 - std::log(40.0)).epsilon(1e-3));
  // (7 + 1) / 2 ln(1 + 64 / 7), the likelihood ratio of Student's distribution.
  CHECK(odds(7.0) == doctest::Approx(4.0 * std::log1p(64.0 / 7.0) - std::log(40.0)));
}

TEST_CASE("sensor faults: nothing is measured before it happens: what seems early has a late reference") {
  const auto delays = [](double gyro, double dvl) {
    DiagnosisResult result{.verdict = "adequate"};
    result.consistency = {finding("gyro", "delay", gyro, 0.001), finding("dvl", "delay", dvl, 0.002)};
    for (ConsistencyFinding& each : result.consistency) each.reference = "pose_capture";
    preflight::adopt_sensor_faults(result);
    REQUIRE(result.effects.size() == 1);
    std::map<std::string, double> numbers;
    for (const NamedValue& number : result.effects[0].parameters) numbers[number.name] = number.value;
    return numbers;
  };
  using Numbers = std::map<std::string, double>;
  CHECK(delays(0.07, 0.22) == Numbers{{"gyro.delay", 0.07}, {"dvl.delay", 0.22}});
  CHECK(delays(-1.0, -0.998) == Numbers{{"pose_capture.delay", 1.0}});
  CHECK(delays(-0.5, 0.25) == Numbers{{"pose_capture.delay", 0.5}, {"dvl.delay", 0.75}});
}

TEST_CASE("sensor faults: what was only reported, held in one run only, or is a count is no effect") {
  DiagnosisResult result{.verdict = "adequate"};
  result.consistency = {finding("dvl", "delay", 0.2, 0.002), finding("dvl", "delay", 0.2, 0.002),
                        finding("pose_capture", "gap", 3.0, 0.0)};
  result.consistency[0].action = "reported only";
  result.consistency[1].run = "surge-1";
  preflight::adopt_sensor_faults(result);
  CHECK(result.effects.empty());
  CHECK(result.verdict == "adequate");
}
