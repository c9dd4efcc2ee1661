// What is done to one recording before it is used: what the sensor check found, in a form that offline tools and live
// processes apply alike.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/estimation/timeline.hpp"

namespace fathom::estimation {

/// How the four numbers of an attitude were meant.
enum class QuaternionForm { kAsRead, kInverse, kScalarLast, kScalarLastInverse };

/// How a heading was counted.
enum class HeadingSense {
  kAsRead,
  kFromEast,      ///< anticlockwise from east: psi := 90 deg - psi
  kAnticlockwise  ///< anticlockwise from north: psi := -psi
};

/// Along which axes a velocity or rates were logged.
enum class VectorFrame {
  kBody,
  kWorld,      ///< the world's: simulators, motion capture
  kEulerRates  ///< of roll, pitch and yaw angle
};

/// How the logged wrench follows from the commands: tau = scale (V / V_curve)^exponent allocation curve(pwm).
struct ThrusterCorrection {
  bool use_commands{false};  ///< false: the logged forces or the logged wrench are used as they are
  double scale{1.0};
  double exponent{};  ///< of the battery's voltage over the curve's
};

/// true = delta_rotation * base * diag(scale) * logged(t + delay) + bias - lever x rates + coupling * rates.
struct SensorFault {
  Eigen::Matrix3d base{Eigen::Matrix3d::Identity()};  ///< signed permutation
  Eigen::Matrix3d rotation{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d scale{Eigen::Vector3d::Ones()};     ///< per logged axis: true over logged
  Eigen::Vector3d bias{Eigen::Vector3d::Zero()};      ///< added to the corrected signal
  Eigen::Vector3d lever{Eigen::Vector3d::Zero()};     ///< m, where the sensor truly measures
  Eigen::Matrix3d coupling{Eigen::Matrix3d::Zero()};  ///< m, what else goes with the rates
  double delay{};                                     ///< s, behind the reference
  double heading{};                                   ///< rad, reference attitude turned against reference position
  [[nodiscard]] Eigen::Matrix3d matrix() const { return rotation * base * scale.asDiagonal(); }
};

/// What is done to one recording before it is used.
struct Corrections {
  QuaternionForm quaternion{QuaternionForm::kAsRead};
  HeadingSense heading_sense{HeadingSense::kAsRead};
  Eigen::Matrix3d attitude_world{Eigen::Matrix3d::Identity()};  ///< of the attitude's world, to NED
  Eigen::Matrix3d attitude_axes{
      Eigen::Matrix3d::Identity()};  ///< R_WB := Rz(heading) attitude_world R_WB attitude_axes
  double heading{};                  ///< rad
  Eigen::Matrix3d position_axes{Eigen::Matrix3d::Identity()};  ///< p_WB := scale position_axes p_WB
  double position_scale{1.0};
  double position_late{};  ///< s by which the position alone lags the attitude beside it
  VectorFrame velocity_frame{VectorFrame::kBody}, rates_frame{VectorFrame::kBody};
  Eigen::Matrix3d velocity_world{Eigen::Matrix3d::Identity()};  ///< of a velocity along the world's axes, to NED
  Eigen::Matrix3d rates_world{Eigen::Matrix3d::Identity()};
  SensorFault gyro, dvl, accelerometer;
  double pose_shift{}, dvl_shift{}, gyro_shift{};  ///< s, added to the stamps to reach the common clock
  std::vector<double> doubtful_pose;  ///< s on the pose's clock: the gyro contradicts the pose around these
  ThrusterCorrection thrusters;
};

/// The four numbers as they were meant.
[[nodiscard]] Eigen::Quaterniond as_meant(QuaternionForm form, const Eigen::Quaterniond& q);
/// The attitude with its heading as it was meant; roll and pitch stay.
[[nodiscard]] Eigen::Quaterniond as_meant(HeadingSense sense, const Eigen::Quaterniond& q);
/// The pose after corrections of form, axes, heading, unit and, where it is a series, the position's own delay; on its
/// own clock.
void correct_pose(const Corrections& corrections, PoseSeries& pose);
/// A vector logged along other axes, along the body's. `pose`: corrected, on the vector's clock. Samples without an
/// attitude near them go.
void to_body(VectorFrame frame, const Eigen::Matrix3d& world, const PoseSeries& pose, Series& vectors);
/// p q r of rates of the Euler angles (roll, pitch, yaw), at this attitude.
[[nodiscard]] Eigen::Vector3d body_rates(const Eigen::Vector3d& euler_rates, const Eigen::Quaterniond& q_WB);
/// Where the attitude belongs at time t, between its neighbours; false outside the data, in gaps and beside what is
/// not valid.
[[nodiscard]] bool attitude_at(const PoseSeries& pose, double t, Eigen::Quaterniond& q_WB);

}  // namespace fathom::estimation
