// Complementary filters for attitude and for position with velocity (Karras et al., gains from cut-off, damping and the
// actual interval), with the covariance that such gains leave. Each keeps its state at one time; the caller orders.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fathom::estimation {

/// Shares of an innovation: to the quantity itself, to its rate (1/s), to the rate's rate (1/s^2).
struct Gains {
  double value{};
  double rate{};
  double second{};
};

/// z_x with low pass 1/(1 + s T_c), T_c = 1/cutoff (the printed 2 pi/cutoff is wrong); backward Euler over `dt`.
[[nodiscard]] Gains first_order_gains(double cutoff, double dt);
/// (2 zeta w s + w^2)/(s^2 + 2 zeta w s + w^2), backward Euler: k_p = X/(1+X), X = (2 zeta w + dt w^2) dt,
/// k_i = dt w^2 (1 - k_p). Stable for every cut-off and interval.
[[nodiscard]] Gains second_order_gains(double cutoff, double damping, double dt);
/// The same with a further pole at the cut-off, for one more integrator (the bias of an accelerometer).
[[nodiscard]] Gains third_order_gains(double cutoff, double damping, double dt);
/// The same for an axis that several sources share: value, rate and second in a ratio that does not depend on the
/// interval, up to two over the cut-off. What the sources disagree by then makes no false speed, whichever of them
/// skips a sample.
[[nodiscard]] Gains proportional_third_order_gains(double cutoff, double damping, double dt);

/// Variances of a quantity x and its rate (or bias) r: the part of a Kalman filter that does not choose the gains.
struct PairCovariance {
  double xx{}, xr{}, rr{};
  /// x += coupling * r * dt, then noise.
  void predict(double coupling, double dt, double noise_xx, double noise_xr, double noise_rr);
  /// x and r moved by their gains times (z - x), where z has variance `noise`.
  void correct_value(double gain_x, double gain_r, double noise);
  /// r moved by gain times (z - r).
  void correct_rate(double gain, double noise);
};

/// Attitude from a rate gyro and measured attitudes; without a gyro from attitudes alone.
class AttitudeFilter {
 public:
  struct Noise {
    double rate{};        ///< rad/s, of one gyro sample
    double bias_walk{};   ///< rad/s per sqrt(s)
    double rate_walk{};   ///< rad/s per sqrt(s), of the true rate when no gyro tells it
    double bias_prior{};  ///< rad/s
  };
  AttitudeFilter(double cutoff, double damping, const Noise& noise);

  void start(const Eigen::Quaterniond& q_WB, double sigma);
  /// The gyro says `w` [rad/s, body] from now on.
  void set_gyro(const Eigen::Vector3d& w);
  /// The gyro is silent: the rate goes on as it is and is learnt from the attitudes.
  void drop_gyro();
  /// To a later time with mean body rate (the gyro's last value when it is not given).
  void predict(double dt);
  void predict(double dt, const Eigen::Vector3d& mean_gyro);
  /// Rotation vector from the estimate to the measured attitude, in B.
  [[nodiscard]] Eigen::Vector3d innovation(const Eigen::Quaterniond& measured) const;
  /// Moves by an innovation that was measured `interval` after the one before.
  void correct(const Eigen::Vector3d& innovation, double interval, double sigma);

  [[nodiscard]] const Eigen::Quaterniond& attitude() const { return q_WB_; }
  [[nodiscard]] Eigen::Vector3d rates() const { return has_gyro_ ? Eigen::Vector3d(gyro_ - bias_) : rate_; }
  [[nodiscard]] const Eigen::Vector3d& bias() const { return bias_; }
  [[nodiscard]] double sigma_rotation() const;
  [[nodiscard]] double sigma_rates() const;

 private:
  double cutoff_, damping_;
  Noise noise_;
  Eigen::Quaterniond q_WB_{Eigen::Quaterniond::Identity()};
  Eigen::Vector3d bias_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d gyro_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d rate_{Eigen::Vector3d::Zero()};
  bool has_gyro_{false};
  PairCovariance with_gyro_;  // rotation and bias, the same on all axes: isotropic noise does not care for turns
  PairCovariance without_;    // rotation and rate
};

/// Position and velocity from position fixes, body velocities and, where there is one, an accelerometer.
class TranslationFilter {
 public:
  struct Noise {
    double acceleration{};    ///< m/s per sqrt(s): what moves the velocity unseen
    double velocity_prior{};  ///< m/s
  };
  TranslationFilter(double cutoff, double damping, double velocity_cutoff, const Noise& noise);

  void start(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& sigma);
  /// Without an accelerometer the body velocity persists: thrust and drag turn with the vehicle. `turn` = R_new
  /// R_old^T.
  void predict(double dt, const Eigen::Matrix3d& turn);
  /// With the specific force f_B [m/s^2] at the body origin: v_W' = R (f - bias) + g, that is v_B' with its Coriolis
  /// term.
  void predict(double dt, const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& f_B);
  /// Position along the world axes that `axes` marks with 1.
  void correct_position(const Eigen::Vector3d& innovation, const Eigen::Vector3d& axes, double interval, double sigma,
                        const Eigen::Matrix3d& R_WB);
  void correct_velocity(const Eigen::Vector3d& innovation_W, double interval, double sigma);

  [[nodiscard]] const Eigen::Vector3d& position() const { return p_WB_; }
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return v_WB_; }
  [[nodiscard]] Eigen::Vector3d sigma_position() const;
  [[nodiscard]] Eigen::Vector3d sigma_velocity_body(const Eigen::Matrix3d& R_WB) const;

 private:
  void grow(double dt);

  double cutoff_, damping_, velocity_cutoff_;
  Noise noise_;
  bool has_force_{false};
  Eigen::Vector3d p_WB_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d v_WB_{Eigen::Vector3d::Zero()};  // along W
  Eigen::Vector3d bias_{Eigen::Vector3d::Zero()};  // of the accelerometer, along B
  PairCovariance covariance_[3];
};

}  // namespace fathom::estimation
