// The paper's filter (Karras et al., eqs. 1.27-1.30 and 1.34-1.37, corrected): position, velocity and accelerometer
// bias from an attitude sensor as input and from position and velocity measurements with complementary gains. It
// carries the covariance that such gains leave, axis by axis of the world; tilt is taken as small there, and only
// there.
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/base/spatial.hpp"

namespace fathom::estimation {

/// Gains of one measurement along three axes: to the quantity, to its rate, to the rate's rate.
struct AxisGains {
  Eigen::Vector3d value{Eigen::Vector3d::Zero()};
  Eigen::Vector3d rate{Eigen::Vector3d::Zero()};    ///< 1/s
  Eigen::Vector3d second{Eigen::Vector3d::Zero()};  ///< 1/s^2
};

class NavigationFilter {
 public:
  struct Noise {
    /// m/s in one second (grows with the root of time), across: accelerometer and what the attitude turns of gravity.
    double acceleration{};
    double vertical_acceleration{};  ///< the same up and down of a level vehicle: the accelerometer alone; 0: as across
    double bias_walk{};              ///< m/s^2 in one second
    double bias_prior{};             ///< m/s^2
    double attitude{};               ///< rad, of roll and pitch
    double gravity{9.81};            ///< m/s^2
  };
  /// Covariance of position p, velocity v and bias b along one axis of W.
  struct AxisCovariance {
    double pp{}, pv{}, pb{}, vv{}, vb{}, bb{};
  };

  explicit NavigationFilter(const Noise& noise) : noise_{noise} {}

  void start(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& sigma_p, const Eigen::Vector3d& v_WB, double sigma_v);
  /// dt later, with mean attitude and mean specific force at the body origin: v_W' = R (f - b) + g, that is
  /// v_B' = f - b + R'g - w x v (eqs. 1.19 and 1.29 corrected).
  void predict(double dt, const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& f_B);
  /// Position measured minus estimated, in W. An axis whose gains are zero is left alone.
  void correct_position(const Eigen::Vector3d& innovation_W, const AxisGains& gains, const Eigen::Vector3d& variance,
                        const Eigen::Matrix3d& R_WB);
  /// Velocity measured minus estimated, in B; gains and variance along B: value to the velocity, rate to the bias.
  void correct_velocity(const Eigen::Vector3d& innovation_B, const AxisGains& gains, const Eigen::Vector3d& variance,
                        const Eigen::Matrix3d& R_WB);
  /// Horizontal velocity measured minus estimated, in W; gains and variance likewise. The vertical is left alone.
  void correct_horizontal_velocity(const Eigen::Vector2d& innovation_W, const AxisGains& gains,
                                   const Eigen::Vector2d& variance, const Eigen::Matrix3d& R_WB);
  /// Nothing was known of the motion for so long, and it may have accelerated by `acceleration` [m/s^2].
  void forget_motion(double seconds, double acceleration);
  /// The estimate was wrong and the measurement is right.
  void set_position(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& axes, const Eigen::Vector3d& variance);
  void set_velocity(const Eigen::Vector3d& v_WB, const Eigen::Vector3d& axes, const Eigen::Vector3d& variance);

  [[nodiscard]] const Eigen::Vector3d& position() const { return p_WB_; }
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return v_WB_; }  ///< along W
  [[nodiscard]] const Eigen::Vector3d& bias() const { return b_; }         ///< of the accelerometer, along B
  [[nodiscard]] const std::array<AxisCovariance, 3>& covariance() const { return covariance_; }
  /// Of [p_WB; v_WB in B].
  [[nodiscard]] Matrix6d covariance_body(const Eigen::Matrix3d& R_WB) const;

 private:
  void learn(const Eigen::Vector3d& lacking_W, const Eigen::Matrix3d& R_WB);

  Noise noise_;
  Eigen::Vector3d p_WB_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d v_WB_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d b_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d tilt_{Eigen::Vector3d::Zero()};  // rad, along B: turns what is told into what is
  std::array<AxisCovariance, 3> covariance_{};
};

}  // namespace fathom::estimation
