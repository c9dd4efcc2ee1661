// Samples to a Kalman filter: which rows a sample gives, what is refused, and how well innovations keep to what the
// filter promises. The live estimator and the smoother of whole trials both run on it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/estimation/online/kalman_start.hpp"
#include "common/estimation/smoothing/smoother.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::estimation {

/// How one instrument fared.
struct InnovationStatistics {
  std::string name;
  std::int64_t used{};
  std::int64_t refused{};  ///< beyond the gate
  std::int64_t dropped{};  ///< not heard
  double nis_sum{};        ///< of the used ones
  double surprise_sum{};   ///< of the normalised innovations squared, refused ones too, each at most the gate's
  double likelihood{};     ///< sum of log p(innovation); a refused one counts as one at the gate
  /// Normalised innovation squared per scalar: 1 when noise is as stated.
  [[nodiscard]] double nis() const { return used > 0 ? nis_sum / static_cast<double>(used) : 0.0; }
};

/// Rows in this order, then one per transponder, and one per accelerometer or gyro beside the inertial package.
enum Instrument : std::size_t {
  kAccelerometer,
  kGyro,
  kHeading,
  kAttitude,
  kDepth,
  kDvl,
  kUsbl,
  kPosePosition,
  kPoseAttitude,
  kTag,
  kFlow,
  kLaser,
  kFirstRange
};

template <int N>
class KinematicEstimator {
 public:
  explicit KinematicEstimator(const KalmanSettings& settings);

  void start(Utime utime, const KalmanStart& start);
  [[nodiscard]] bool started() const { return started_; }
  /// Goes on to `utime`; long gaps are taken in steps. A record gets every step but the last, which close() adds.
  void advance(Utime utime, FilterRecord<N>* record);
  /// Takes one sample of this instant in.
  void take(const SampleView& sample, FilterRecord<N>* record);
  void close(FilterRecord<N>* record);

  [[nodiscard]] const KalmanFilter<N>& filter() const { return filter_; }
  [[nodiscard]] const std::vector<InnovationStatistics>& statistics() const { return statistics_; }
  [[nodiscard]] double likelihood() const;
  /// False from the moment when the attitude left what its angles can tell: it was lost between two samples.
  [[nodiscard]] bool oriented() const { return oriented_ && filter_.tells_attitude(); }

 private:
  void use(const Ahrs& sample);
  void use(const PoseCapture& sample);
  void use(const Dvl& sample);
  void use(const Depth& sample);
  void use(const Usbl& sample);
  void use(const Ranges& sample);
  void use(const TagPose& sample);
  void use(const OpticalFlow& sample);
  void use(const LaserRange& sample);
  void use(const Signal& sample);
  [[nodiscard]] const KnownCamera* camera(const std::string& name) const;
  [[nodiscard]] std::size_t first_single() const { return kFirstRange + settings_->transponders.size(); }
  [[nodiscard]] bool within_walls(const Eigen::Vector3d& p_W) const;
  void apply(std::size_t instrument, const model::Observation& observation);
  void doubt(std::size_t instrument);
  void doubt_if_lost();
  void doubt_odd_ranges(const Ranges& sample, const model::KinematicPoint& point);

  const KalmanSettings* settings_;
  KalmanFilter<N> filter_;
  typename KalmanFilter<N>::State moved_{KalmanFilter<N>::State::Zero()};
  FilterRecord<N>* record_{};
  std::vector<InnovationStatistics> statistics_;
  std::vector<int> in_a_row_;      // refused
  std::vector<double> ranges_;     // of one message; 0: not heard, or contradicts the others
  std::optional<Utime> attitude_;  // of the newest sample that told one
  Utime now_{};
  bool open_{};  // time has gone on since the last record
  bool started_{false}, oriented_{true};
};

/// STATE of a filter's or smoother's numbers: velocity turned into B, spread with it.
[[nodiscard]] StateEstimate state_of(Utime utime, const model::KinematicVector& x,
                                     const model::KinematicVector& variance,
                                     const std::optional<Eigen::Matrix3d>& reference);

extern template class KinematicEstimator<model::kKinematicStates>;
extern template class KinematicEstimator<model::kInertialStates>;
extern template class KinematicEstimator<model::kLoggedStates>;
extern template class KinematicEstimator<model::kMostStates>;

}  // namespace fathom::estimation
