// What hides in an instrument, on line: the sensors are compared with STATE and with each other while the trial runs. A
// late or wrongly scaled gyro looks like a force to whoever trusts it; named as the sensor's fault, it accuses no
// water.
#pragma once

#include <deque>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "common/consistency/consistency.hpp"
#include "common/consistency/flow_check.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/recording.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::diagnosis {

/// Looks whenever the trial has become twice as long, beside the caller, and says what it found a fixed time of the
/// messages later: how quick the machine is does not count, nor which channel comes first, up to a second.
class LiveSensorCheck {
 public:
  /// `corrections`: those that STATE is made with; what they mend is no finding.
  /// `flow`: where the camera and the tags are, if they are known: only then TAG_POSE and OPTICAL_FLOW are compared.
  explicit LiveSensorCheck(estimation::Corrections corrections = {},
                           std::optional<consistency::FlowWitnesses> flow = {});

  void hear(const Ahrs& ahrs);
  void hear(const Dvl& dvl);
  void hear(const TagPose& tag);
  void hear(const OpticalFlow& flow);
  /// In the order of time.
  void step(const StateEstimate& state);
  /// Looks at all there is, at once.
  void finish();
  void reset();

  /// How far the axes of gyro and DVL are turned against the body: true = R * logged. No effect of the water, and none
  /// that a name accuses: what rests on the sensors is turned back.
  struct Turns {
    Eigen::Matrix3d gyro{Eigen::Matrix3d::Identity()}, dvl{Eigen::Matrix3d::Identity()};
    bool operator==(const Turns&) const = default;
  };
  [[nodiscard]] const Turns& turns() const { return turns_; }

  /// sensor_latency, sensor_scale and lever_arm of AHRS, DVL and optical flow, most certain first; the variant is the
  /// signal. What was found stays until a later look can judge the same sensor.
  [[nodiscard]] const std::vector<EffectEvidence>& faults() const { return faults_; }
  /// True when places that velocities had no part in have been compared with them: then forces need not be asked.
  [[nodiscard]] bool velocity_judged() const { return velocity_judged_; }

 private:
  struct Sample {
    Utime utime{};
    Eigen::Vector3d x;
  };
  struct Found {
    std::vector<EffectEvidence> faults;
    std::vector<std::string> judged;  // signals
    Turns turns;
  };
  void keep(std::deque<Sample>& samples, const Sample& sample) const;
  struct Seen {
    Recording sensors, pictures;
    std::optional<model::Site> site;  // of the pictures
  };
  template <class Message>
  void hear_picture(const Message& message);
  [[nodiscard]] Seen until(Utime end) const;
  [[nodiscard]] static Found look(const Seen& seen);
  void take(Found found);

  estimation::Corrections corrections_;
  std::deque<Sample> rates_, velocities_;
  std::deque<consistency::MotionAt> states_;
  std::optional<consistency::FlowWitnesses> flow_;
  std::optional<Utime> first_;
  double next_look_{};  // s of the trial
  Utime due_{};
  std::future<Found> look_;
  std::vector<EffectEvidence> faults_;
  Turns turns_;
  bool velocity_judged_{false};
};

}  // namespace fathom::diagnosis
