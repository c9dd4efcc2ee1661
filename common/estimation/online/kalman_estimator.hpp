// The Kalman filter as an estimator on line, an alternative to the complementary filters: samples in, STATE out.
// Samples are taken in the order of their time, a fixed latency behind the newest, so that the order of arrival does
// not matter.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/estimation/online/kinematic_estimator.hpp"

namespace fathom::estimation {

class KalmanEstimator {
 public:
  using Output = std::vector<StateEstimate>;

  explicit KalmanEstimator(const KalmanSettings& settings);
  KalmanEstimator(const KalmanEstimator&) = delete;  // the filter inside points to the settings
  KalmanEstimator& operator=(const KalmanEstimator&) = delete;

  /// What the call released, in the order of time: one estimate per sample of the inertial package, or of the pose
  /// capture where there is none. The reference is good until the next call.
  const Output& step(const Ahrs& sample) { return wait({sample.utime, sample}); }
  const Output& step(const PoseCapture& sample) { return wait({sample.utime, sample}); }
  const Output& step(const Dvl& sample) { return wait({sample.utime, sample}); }
  const Output& step(const Depth& sample) { return wait({sample.utime, sample}); }
  const Output& step(const Usbl& sample) { return wait({sample.utime, sample}); }
  const Output& step(const Ranges& sample) { return wait({sample.utime, sample}); }
  const Output& step(const TagPose& sample) { return wait({sample.utime, sample}); }
  /// Flow and laser need a floor in the settings; without one they are not used.
  const Output& step(const OpticalFlow& sample) { return wait({sample.utime, sample}); }
  const Output& step(const LaserRange& sample) { return wait({sample.utime, sample}); }
  /// Columns that no instrument of the settings tells are not used. A column has whosever clock: it moves the time of
  /// nothing else, and what lies further from the other instruments' than `latency` is refused.
  const Output& step(const Signal& sample);
  /// The input has ended: everything that waits.
  const Output& finish();
  /// A log started over.
  void reset();

  /// Samples not used, by reason: "late", "range B gated", "dvl not heard", "no start yet", "ahead".
  [[nodiscard]] std::map<std::string, std::int64_t> rejected() const;

 private:
  using Sample = std::variant<Ahrs, PoseCapture, Dvl, Depth, Usbl, Ranges, TagPose, OpticalFlow, LaserRange, Signal>;
  struct Event {
    Utime utime{};
    Sample sample;
  };
  using Machine = std::variant<KinematicEstimator<model::kKinematicStates>, KinematicEstimator<model::kInertialStates>,
                               KinematicEstimator<model::kLoggedStates>, KinematicEstimator<model::kMostStates>>;

  const Output& wait(Event event);
  void release(Utime until);
  void use(const Event& event);
  [[nodiscard]] bool used(const Sample& sample) const;
  void say(Utime utime);
  [[nodiscard]] Machine machine() const;

  KalmanSettings settings_;
  Machine machine_;
  StartFinder finder_;
  std::vector<Event> waiting_;
  std::optional<Utime> newest_, now_, inertial_, fixed_;
  Output output_;
  std::int64_t late_{}, unstarted_{}, ahead_{};
};

}  // namespace fathom::estimation
