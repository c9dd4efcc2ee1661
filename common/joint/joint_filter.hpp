// Extended Kalman filter whose state is the vehicle's motion together with its dynamic parameters: the base model moves
// it, every instrument corrects it. Fixed storage, no allocation; covariance updates in Joseph's form wherever rounding
// could matter, so that it stays positive from priors of hundreds to noise of millimetres.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "common/joint/normalised.hpp"

namespace fathom::joint {

/// Where the parts of the state begin.
namespace part {
constexpr int kPosition = 0;     ///< m, p_WB
constexpr int kNu = 3;           ///< m/s and rad/s, u v w p q r
constexpr int kAttitude = 9;     ///< rad: true R_WB = told R_WB exp(skew(e))
constexpr int kBias = 12;        ///< m/s^2, of the accelerometer in B
constexpr int kScale = 15;       ///< share by which heights or the velocity log read too large
constexpr int kHeight = 16;      ///< m by which the laser tells the body deeper than tags do
constexpr int kOffset = 17;      ///< m/s, of the velocity log in B
constexpr int kTurned = 20;      ///< rad: gyros and accelerometers tell exp(skew(kTurned)) times what is in B
constexpr int kParameters = 23;  ///< normalised
}  // namespace part

constexpr int kMostStates = part::kParameters + model::kBaseParameterCount;
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostStates, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostStates, kMostStates>;

/// What drives the state, and how unsure it begins. Densities: standard deviation of the mean over one second.
struct JointNoise {
  double acceleration{3e-3};                        ///< m/s^2, of what the model lacks along X Y Z
  double turning{1e-2};                             ///< rad/s^2, likewise about K M N
  double bias_walk{2e-3};                           ///< m/s^2 in one second
  double bias_prior{0.05};                          ///< m/s^2
  double attitude{3.5e-3};                          ///< rad, standard deviation of the told attitude...
  double attitude_memory{30.0};                     ///< s, ...which goes on for about so long
  double scale{0.0};                                ///< prior of kScale
  double height{0.0};                               ///< m, prior of kHeight
  Eigen::Vector3d offset{Eigen::Vector3d::Zero()};  ///< m/s, prior of kOffset
  double turned{0.0};                               ///< rad, prior of kTurned
};

/// One scalar measurement, linearised at the state as it stood before its instant's first row.
struct JointRow {
  JointVector h;
  double innovation{};
  double variance{};
  /// Covariance of its noise with the state's [rows kNu...], where the measurement feels what also moves the vehicle.
  Vector6d shared{Vector6d::Zero()};
  bool of_motion{true};  ///< h is zero behind part::kParameters
  double score{};        ///< set by update(): the innovation in its standard deviations; 0 where it was refused
};

class JointFilter {
 public:
  /// `mean` and `sigma` of the parameters are normalised ones.
  JointFilter(const Normalised& model, const JointNoise& noise, const ParameterVector& mean,
              const ParameterVector& sigma);

  /// The motion begins anew, with standard deviations; parameters and what instruments are off by are kept.
  void start(const Eigen::Vector3d& p_WB, const Vector6d& nu, const Vector6d& sigma_p_v, double sigma_rates);
  /// dt [s] on under the wrench tau [N, N m], from one told attitude to the other.
  void predict(double dt, const Eigen::Matrix3d& R_from, const Eigen::Matrix3d& R_middle, const Eigen::Matrix3d& R_to,
               const Vector6d& tau);
  /// Rows of one instant, all linearised now; refused beyond `gate` standard deviations. How many were taken.
  int update(std::span<JointRow> rows, double gate);

  /// An axis begins to be moved by the model, and its parameters to be learnt: means and covariance of all of them in
  /// SI, of which those of this axis are taken. Its inertia must be positive.
  void teach(int axis, const ParameterVector& mean, const ParameterMatrix& covariance);
  /// The same for what belongs to axes that are not simulated and enters the others' equations.
  void teach_rest(const ParameterVector& mean, const ParameterMatrix& covariance);
  /// A held parameter keeps value and variance, and its doubt still widens that of the others (Schmidt 1966).
  void hold(int parameter, bool held);

  /// Moves the estimate by hand.
  void shift(const JointVector& by) { x_ += by; }
  [[nodiscard]] const JointVector& state() const { return x_; }
  [[nodiscard]] const JointMatrix& covariance() const { return P_; }
  [[nodiscard]] Vector6d nu() const { return x_.segment<6>(part::kNu); }
  [[nodiscard]] ParameterVector parameters() const { return x_.tail(model_.size()); }
  [[nodiscard]] ParameterMatrix parameter_covariance() const;
  [[nodiscard]] const Normalised& model() const { return model_; }
  [[nodiscard]] int size() const { return static_cast<int>(x_.size()); }
  /// Parameters and their covariance as saved; the motion has to begin anew. False when they are not usable.
  bool restore(const ParameterVector& mean, const ParameterMatrix& covariance);
  /// Finite, variances not negative, inertias that move anything positive and not beyond all bounds.
  [[nodiscard]] bool sane() const;

 private:
  using Transition = Eigen::Matrix<double, 9, Eigen::Dynamic, Eigen::ColMajor, 9, kMostStates>;
  void move(double dt, const Eigen::Matrix3d& R_from, const Eigen::Matrix3d& R_middle, const Eigen::Matrix3d& R_to,
            const Vector6d& tau, Transition& F);
  void diffuse(double dt);
  bool take(JointRow& row, double innovation, double gate, JointVector& moved);
  [[nodiscard]] bool still(int parameter) const;
  void count_still();

  Normalised model_;
  JointNoise noise_;
  JointVector x_;
  JointMatrix P_;
  std::array<bool, model::kBaseParameterCount> held_{};
  bool any_still_{true}, rest_taught_{false};
};

}  // namespace fathom::joint
