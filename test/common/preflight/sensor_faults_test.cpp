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
  const std::vector<ConsistencyFinding> findings{
      finding("dvl", "delay", 0.2, 0.002), finding("dvl.u", "scale", 0.8, 0.01), finding("dvl.v", "scale", 0.9, 0.01),
      finding("dvl", "lever_arm_x", 0.1, 0.01)};
  const std::vector<EffectFound> effects = preflight::sensor_faults(findings);
  REQUIRE(effects.size() == 3);
  CHECK(effects[0].name == "sensor_latency");
  CHECK(effects[1].name == "sensor_scale");
  CHECK(effects[1].variant == "dvl.u, dvl.v");
  REQUIRE(effects[1].parameters.size() == 2);
  CHECK(effects[1].parameters[0].value == doctest::Approx(0.25));
  CHECK(effects[1].parameters[0].std == doctest::Approx(0.01 / 0.64));
  CHECK(effects[2].name == "lever_arm");
  CHECK(effects[0].log_odds > 3.0);
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
    std::vector<ConsistencyFinding> findings{finding("dvl", "lever_arm_x", 0.08, 0.01)};
    findings[0].freedom = freedom;
    return preflight::sensor_faults(findings).at(0).log_odds;
  };
  CHECK(odds(1e6) == doctest::Approx(32.0 - std::log(40.0)).epsilon(1e-3));
  // (7 + 1) / 2 ln(1 + 64 / 7), the likelihood ratio of Student's distribution.
  CHECK(odds(7.0) == doctest::Approx(4.0 * std::log1p(64.0 / 7.0) - std::log(40.0)));
}

TEST_CASE("sensor faults: nothing is measured before it happens: what seems early has a late reference") {
  const auto delays = [](double gyro, double dvl) {
    std::vector<ConsistencyFinding> findings{finding("gyro", "delay", gyro, 0.001),
                                             finding("dvl", "delay", dvl, 0.002)};
    for (ConsistencyFinding& each : findings) each.reference = "pose_capture";
    const std::vector<EffectFound> effects = preflight::sensor_faults(findings);
    REQUIRE(effects.size() == 1);
    std::map<std::string, double> numbers;
    for (const NamedValue& number : effects[0].parameters) numbers[number.name] = number.value;
    return numbers;
  };
  using Numbers = std::map<std::string, double>;
  CHECK(delays(0.07, 0.22) == Numbers{{"gyro.delay", 0.07}, {"dvl.delay", 0.22}});
  CHECK(delays(-1.0, -0.998) == Numbers{{"pose_capture.delay", 1.0}});
  CHECK(delays(-0.5, 0.25) == Numbers{{"pose_capture.delay", 0.5}, {"dvl.delay", 0.75}});
}

TEST_CASE("sensor faults: what was only reported, held in one run only, or is a count is no effect") {
  std::vector<ConsistencyFinding> findings{finding("dvl", "delay", 0.2, 0.002), finding("dvl", "delay", 0.2, 0.002),
                                           finding("pose_capture", "gap", 3.0, 0.0)};
  findings[0].action = "reported only";
  findings[1].run = "surge-1";
  CHECK(preflight::sensor_faults(findings).empty());
}
