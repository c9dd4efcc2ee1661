// Faults of the Beluga recordings that an independent exploration found by other means.
#include <doctest/doctest.h>

#include <cstdio>

#include "common/estimation/reconstruct.hpp"
#include "test/support/beluga_csv.hpp"
#include "test/support/consistency.hpp"

namespace fathom {
using test::find;

TEST_CASE("the sensors of the Beluga recordings disagree as independent analysis found") {
  const std::vector<Recording> runs = test::read_all_beluga();
  REQUIRE(runs.size() == 6);
  consistency::ConsistencyResult result = consistency::check_consistency(runs);
  for (const ConsistencyFinding& one : result.findings) {
    std::printf("%-9s %-22s %-16s %10.5g %-8s %s | %s\n", one.run.c_str(), one.signal.c_str(), one.finding.c_str(),
                one.size, one.unit.c_str(), one.evidence.c_str(), one.action.c_str());
  }
  const model::Vehicle beluga = model::Vehicle::load(std::string(FATHOM_SOURCE_DIR) + "/config/vehicles/beluga.yaml");
  const std::size_t before = result.findings.size();
  consistency::check_thrusters(runs, beluga, result);
  for (std::size_t i = before; i < result.findings.size(); ++i) {
    const ConsistencyFinding& one = result.findings[i];
    std::printf("%-9s %-22s %-16s %10.5g %-8s %s | %s\n", one.run.c_str(), one.signal.c_str(), one.finding.c_str(),
                one.size, one.unit.c_str(), one.evidence.c_str(), one.action.c_str());
  }
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Trial trial = estimation::reconstruct(runs[r], result.corrections[r], beluga);
    CHECK(trial.dt == doctest::Approx(0.1));
    CHECK(trial.size() > runs[r].ahrs.size() - 5);
    CHECK(trial.observed.velocity);
    CHECK(trial.input.size() == trial.size());
    CHECK_FALSE(trial.input_is_wrench);
    double valid = 0.0;
    for (const auto one : trial.velocity_valid) valid += one;
    std::printf("%-9s nu sigma %.4f %.4f %.4f m/s %.5f %.5f %.5f rad/s, velocity valid %.3f\n", trial.name.c_str(),
                trial.nu_sigma[0], trial.nu_sigma[1], trial.nu_sigma[2], trial.nu_sigma[3], trial.nu_sigma[4],
                trial.nu_sigma[5], valid / static_cast<double>(trial.size()));
  }

  REQUIRE(find(result.findings, "gyro.p", "sign") != nullptr);
  REQUIRE(find(result.findings, "gyro.q", "sign") != nullptr);
  CHECK(find(result.findings, "gyro.r", "sign") == nullptr);
  REQUIRE(find(result.findings, "gyro", "delay") != nullptr);
  constexpr double kDelay = 0.074, kDelayTolerance = 0.010;  // s, from an analysis with another method
  CHECK(find(result.findings, "gyro", "delay")->size == doctest::Approx(kDelay).epsilon(kDelayTolerance / kDelay));
  REQUIRE(find(result.findings, "dvl", "delay") != nullptr);
  CHECK(find(result.findings, "dvl", "delay")->size > 0.20);  // 0.22 fresh, 0.235 with held samples
  CHECK(find(result.findings, "dvl", "delay")->size < 0.25);
  const ConsistencyFinding* scale = find(result.findings, "dvl.u", "scale");
  REQUIRE(scale != nullptr);
  CHECK(scale->size == doctest::Approx(0.979).epsilon(0.006));
  const ConsistencyFinding* tilt = find(result.findings, "pose_capture.attitude", "tilt");
  REQUIRE(tilt != nullptr);
  CHECK(tilt->size == doctest::Approx(0.061).epsilon(0.1));  // rad: 3.5 degrees
}

}  // namespace fathom
