// What hides in an instrument, on line: the sensors are compared with STATE and with each other while the trial runs. A
// late or wrongly scaled gyro looks like a force to whoever trusts it; named as the sensor's fault, it accuses no
// water.
#pragma once

#include <deque>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "common/estimation/consistency.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/recording.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::diagnosis {

/// Looks whenever the trial has become twice as long, beside the caller, and says what it found a fixed time of the
/// messages later: how quick the machine is does not count, nor which channel comes first, up to a second.
class LiveSensorCheck {
 public:
  /// `corrections`: those that STATE is made with; what they mend is no finding.
  explicit LiveSensorCheck(estimation::Corrections corrections = {});

  void hear(const Ahrs& ahrs);
  void hear(const Dvl& dvl);
  /// In the order of time.
  void step(const StateEstimate& state);
  /// Looks at all there is, at once.
  void finish();
  void reset();

  /// sensor_latency, sensor_scale and lever_arm of AHRS and DVL, most certain first; the variant is the signal. What
  /// was found stays until a later look can judge the same sensor.
  [[nodiscard]] const std::vector<EffectEvidence>& faults() const { return faults_; }

 private:
  struct Sample {
    Utime utime{};
    Eigen::Vector3d x;
  };
  struct Found {
    std::vector<EffectEvidence> faults;
    std::vector<std::string> judged;  // signals
  };
  void keep(std::deque<Sample>& samples, const Sample& sample) const;
  [[nodiscard]] Recording until(Utime end) const;
  [[nodiscard]] static Found look(const Recording& recording);
  void take(Found found);

  estimation::Corrections corrections_;
  std::deque<Sample> rates_, velocities_;
  std::deque<PoseCapture> pose_;
  std::optional<Utime> first_;
  double next_look_{};  // s of the trial
  Utime due_{};
  std::future<Found> look_;
  std::vector<EffectEvidence> faults_;
};

}  // namespace fathom::diagnosis
