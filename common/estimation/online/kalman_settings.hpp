// Settings of the Kalman estimator: which instrument sits where and how well it measures, what drives the motion, how
// unsure the beginning is.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/estimation/online/kalman_filter.hpp"
#include "common/model/mounts.hpp"
#include "common/model/sensors/tag_pose.hpp"

namespace fathom {
class Config;
}

namespace fathom::estimation {

/// How much of an AHRS's attitude is believed.
enum class AttitudeUse { kNothing, kHeading, kEverything };

struct Transponder {
  std::string name;
  Eigen::Vector3d p_WT{Eigen::Vector3d::Zero()};  ///< m
  bool used{true};                                ///< false: it contradicts the others
};

struct KnownTag {
  int number{};
  model::Pose X_WT;
};

struct KnownCamera {
  std::string name;
  model::Pose X_BC;
};

/// An accelerometer or gyro beside the inertial package.
struct SingleInertial {
  model::SingleInertialMount mount;
  std::optional<double> noise;  ///< m/s^2 or rad/s of one sample; else the mean of the package's
};

struct KalmanSettings {
  KinematicModel model{KinematicModel::kCoupled};
  ProcessNoise process;
  bool biases{true};    ///< of accelerometers and gyros are states
  double gate{5.0};     ///< sigma beyond which an observation is refused
  double latency{0.3};  ///< s behind the newest sample (live)
  double max_gap{1.0};  ///< s without position or velocity after which the state is no longer valid

  double gravity{model::kGravity};                                       ///< m/s^2, the site's where it is known
  Eigen::Vector3d p_BI{Eigen::Vector3d::Zero()};                         ///< m, inertial package
  Eigen::Matrix3d R_BI{Eigen::Matrix3d::Identity()};                     ///< what its mounting is off by
  Eigen::Vector3d accelerometer_noise{Eigen::Vector3d::Constant(0.05)};  ///< m/s^2 of one sample, per axis
  Eigen::Vector3d gyro_noise{Eigen::Vector3d::Constant(0.005)};          ///< rad/s of one sample, per axis
  double accelerometer_bias{0.05};                                       ///< m/s^2, prior
  double gyro_bias{0.005};                                               ///< rad/s, prior
  std::vector<SingleInertial> singles;  ///< kMostSingles at most; they are as noisy and biased as the package

  AttitudeUse attitude{AttitudeUse::kEverything};
  static constexpr double kHeadingNoise = 0.02;  ///< rad
  double attitude_noise{0.01};                   ///< rad
  /// s for which an attitude's error goes on: the instrument filters, and what its filter leaves wanders. Samples
  /// within are no new witnesses. 0: each errs anew.
  double attitude_memory{};
  std::optional<double> heading_noise;  ///< rad; else kHeadingNoise alone, and with the tilt as attitude_noise
  double declination{};                 ///< rad, of a magnetic heading

  Eigen::Vector3d p_BP{Eigen::Vector3d::Zero()};  ///< m, pressure port; zero where the driver has removed it
  double depth_noise{0.02};                       ///< m

  Eigen::Vector3d p_BA{Eigen::Vector3d::Zero()};  ///< m, acoustic transducer
  double range_noise{0.1};                        ///< m
  std::vector<Transponder> transponders;          ///< in the order of RANGES; empty: ranges are not used

  double velocity_noise{0.02};  ///< m/s, velocity log at the body's origin
  double velocity_bias{};       ///< m/s, prior of the log's bias, which is then a state; 0: it is none
  Eigen::Vector3d velocity_scale{Eigen::Vector3d::Ones()};  ///< of the log, along B: true over what is read
  double usbl_noise{0.1};                                   ///< m, added to what a fix says of itself
  double position_noise{0.002};                             ///< m, motion capture
  double capture_attitude_noise{0.005};                     ///< rad, motion capture

  std::vector<KnownTag> tags;
  std::vector<KnownCamera> cameras;
  double tag_noise{0.01};           ///< share of the distance, along the line of sight; a third of it across
  double tag_attitude_noise{0.05};  ///< rad
  bool tag_attitude{true};          ///< false: a tag tells where it is alone, not how it is turned

  std::optional<double> floor;  ///< m, z of a level floor; without one neither flow nor laser can be used
  Eigen::AlignedBox2d walls{Eigen::Vector2d::Constant(-HUGE_VAL), Eigen::Vector2d::Constant(HUGE_VAL)};  ///< m, x and y
  bool flow{true}, laser{true};                         ///< used, where there is a floor
  double flow_noise{0.002};                             ///< m/s, added to what a sample says of itself
  Eigen::Vector3d flow_scale{Eigen::Vector3d::Ones()};  ///< true over what is read
  double laser_noise{0.002};                            ///< m, added likewise

  /// What no averaging removes (places of tags, a compass's offset, the speed of sound): part of what is stated, and
  /// not of the gains. m in W, rad and m/s in B.
  Eigen::Vector3d lasting_position{Eigen::Vector3d::Zero()}, lasting_attitude{Eigen::Vector3d::Zero()},
      lasting_velocity{Eigen::Vector3d::Zero()};

  std::optional<Eigen::Vector3d> start;  ///< m, position at the beginning; else from the first measurements
  double start_position{2.0};            ///< m
  double start_velocity{0.5};            ///< m/s
  double start_tilt{0.2};                ///< rad
  double start_rates{0.2};               ///< rad/s
  double start_acceleration{0.2};        ///< m/s^2; the rates' derivatives the same in rad/s^2

  /// How many states its filter has: 18, 24, 27 or 36.
  [[nodiscard]] int states() const {
    if (!singles.empty()) return model::kMostStates;
    if (velocity_bias > 0.0) return model::kLoggedStates;
    return biases ? model::kInertialStates : model::kKinematicStates;
  }

  /// Instruments beside the inertial package, as the vehicle file has them.
  void add_singles(const std::vector<model::SingleInertialMount>& mounts);
  /// The one that a column of that name tells, or none.
  [[nodiscard]] std::optional<std::size_t> single(const std::string& signal) const;

  /// Reads the section "estimator" of a file whose `filter` is `ekf`. Every key may be left out; docs/configuration.md.
  [[nodiscard]] static KalmanSettings from(const Config& config);
};

}  // namespace fathom::estimation
