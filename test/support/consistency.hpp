// Made-up recordings through the sensor check: what it finds, and what is left of the faults in the motion.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/consistency/consistency.hpp"
#include "common/estimation/reconstruct.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom::test {

/// What the sensor check makes of one recording.
struct Checked {
  SyntheticOptions options;
  Recording recording;
  consistency::ConsistencyResult result;
  [[nodiscard]] const std::vector<ConsistencyFinding>& findings() const { return result.findings; }
};

inline Checked check(const SyntheticOptions& options) {
  Checked checked{.options = options, .recording = synthetic_recording(options), .result = {}};
  checked.result = consistency::check_consistency(std::span(&checked.recording, 1));
  return checked;
}

inline const ConsistencyFinding* find(const std::vector<ConsistencyFinding>& findings, const std::string& signal,
                                      const std::string& what) {
  for (const ConsistencyFinding& one : findings) {
    if (one.signal == signal && one.finding == what) return &one;
  }
  return nullptr;
}

inline void print(const std::vector<ConsistencyFinding>& findings) {
  for (const ConsistencyFinding& one : findings) {
    std::printf("   %s %s %s %.5g %s: %s\n", one.run.c_str(), one.signal.c_str(), one.finding.c_str(), one.size,
                one.unit.c_str(), one.evidence.c_str());
  }
}

/// Root mean square error of the reconstructed nu against the truth.
inline Vector6d error_of(const Checked& checked) {
  const SyntheticOptions& options = checked.options;
  const Trial trial = estimation::reconstruct(checked.recording, checked.result.corrections[0], model::Vehicle{});
  const SyntheticMotion motion(options.seed);
  // The common clock is the gyro's: its delay is part of it.
  const double block = std::max(1.0, std::round(trial.dt * options.gyro_rate));
  const double begin = 0.5 * (block - 1.0) / options.gyro_rate - options.gyro_delay;
  Vector6d sum = Vector6d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < trial.size(); ++i) {
    if (!trial.velocity_valid[i] || !trial.rates_valid[i]) continue;
    const double t = begin + trial.t[i];
    const Vector6d truth = (Vector6d() << motion.v_B(t), motion.w_B(t)).finished();
    sum += (trial.nu[i] - truth).cwiseAbs2();
    count += 1.0;
  }
  REQUIRE(count > 100.0);
  return (sum / count).cwiseSqrt();
}

inline constexpr double kVelocityTolerance = 0.012;  // m/s: sensor noise of 5 mm/s and what is left of the fault
inline constexpr double kRateTolerance = 0.008;      // rad/s: noise of 0.2 deg/s and what is left of the fault

/// The faults are not only named: the motion comes out right in spite of them.
inline void check_motion(const Checked& checked) {
  const Vector6d error = error_of(checked);
  INFO("rmse of nu: ", error.transpose());
  CHECK(error.head<3>().maxCoeff() < kVelocityTolerance);
  CHECK(error.tail<3>().maxCoeff() < kRateTolerance);
}

}  // namespace fathom::test
