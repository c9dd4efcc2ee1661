// The estimator: sensor samples in, STATE out. Samples are corrected, put onto one clock and taken in the order of that
// clock, a fixed latency behind the newest, so that the order of arrival does not matter. Complementary filters after
// Karras et al.; every estimate carries its standard deviations.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/estimation/corrections.hpp"
#include "common/estimation/online/complementary_filter.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/sensors.hpp"

namespace fathom {
class Config;
}

namespace fathom::estimation {

struct EstimatorSettings {
  double attitude_cutoff{2.0};  ///< rad/s: below it the measured attitude counts, above it the gyro
  double position_cutoff{8.0};  ///< rad/s, of position and, by it, velocity
  double velocity_cutoff{4.0};  ///< rad/s, of the velocity log
  double damping{0.8};          ///< 1, of the second-order filters
  double latency{0.3};          ///< s behind the newest: more than clock corrections and delays, plus one gyro interval
  double max_gap{1.0};          ///< s without a measurement after which a part is no longer valid
  double gate{6.0};             ///< sigma beyond which a measurement is refused
  double position_noise{};      ///< m, pose capture
  double attitude_noise{};      ///< rad, pose capture or AHRS
  double depth_noise{};         ///< m
  double velocity_noise{};      ///< m/s, velocity log
  double rate_noise{};          ///< rad/s, one gyro sample
  double bias_walk{};           ///< rad/s in one second (random walks grow with the root of time)
  double bias_prior{};          ///< rad/s
  double acceleration_walk{};   ///< m/s in one second, by what no sensor sees
  double rate_walk{};           ///< rad/s in one second, the same for the rates; used without a gyro

  /// Keys as above, with units.
  [[nodiscard]] static EstimatorSettings from(const Config& config);
};

class Estimator {
 public:
  using Output = std::vector<StateEstimate>;

  Estimator(const EstimatorSettings& settings, const Corrections& corrections);

  /// What the call released, in the order of time: one estimate per gyro sample, or per pose where there is no gyro.
  /// The reference is good until the next call.
  const Output& step(const PoseCapture& sample);
  const Output& step(const Ahrs& sample);
  const Output& step(const Dvl& sample);
  const Output& step(const Depth& sample);
  /// The input has ended: everything that waits.
  const Output& finish();
  /// A log started over.
  void reset();

  /// Samples not used, by reason: "late", "pose gated", "dvl gated", ...
  [[nodiscard]] const std::map<std::string, std::int64_t>& rejected() const { return rejected_; }

 private:
  struct Event {
    Utime utime{};                                       // corrected
    std::variant<Ahrs, PoseCapture, Dvl, Depth> sample;  // at equal times in this order
  };
  /// One kind of measurement: when it last counted, and how often in a row it was refused.
  struct Track {
    std::optional<Utime> last;
    int refused{};
  };

  struct Gyro {
    Utime utime{};
    Eigen::Vector3d w{Eigen::Vector3d::Zero()};  // corrected
  };

  const Output& take(Utime raw, double shift, Event event);
  void release(Utime until);
  void advance(Utime utime);
  [[nodiscard]] Eigen::Vector3d corrected_rates(const Ahrs& sample) const;
  [[nodiscard]] Eigen::Vector3d gyro_at(double seconds_after_last) const;
  void use(const PoseCapture& sample);
  void use(const Ahrs& sample);
  void use(const Dvl& sample);
  void use(const Depth& sample);
  void use_attitude(const Eigen::Quaterniond& q_WB);
  void use_position(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& axes, double sigma, Track& track,
                    const char* reason);
  [[nodiscard]] bool passes(double error, double sigma, Track& track, const char* reason);
  [[nodiscard]] double interval(const Track& track, double otherwise) const;
  [[nodiscard]] bool fresh(const Track& track) const;
  void say();

  EstimatorSettings settings_;
  Corrections corrections_;
  AttitudeFilter attitude_;
  TranslationFilter translation_;
  PoseSeries one_pose_;  // for correct_pose, its memory kept
  std::optional<PoseCapture> last_pose_;
  std::vector<Event> waiting_;  // in the order of utime
  std::optional<Utime> newest_, now_;
  Track rotation_, position_, depth_, velocity_, gyro_track_, force_, captured_;
  std::optional<double> depth_offset_;  // m, depth over the capture's z
  std::optional<Utime> moving_since_;   // since when velocity rests on measurements without a gap
  Gyro last_gyro_;
  std::optional<Gyro> next_gyro_;  // already here, since estimates are made `latency` behind
  Eigen::Vector3d last_force_{Eigen::Vector3d::Zero()};
  Output output_;
  std::map<std::string, std::int64_t> rejected_;
};

}  // namespace fathom::estimation
