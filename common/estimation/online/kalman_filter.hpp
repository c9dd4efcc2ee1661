// Extended Kalman filter on the kinematic model of Pereira and Duncan (eqs. 6 to 11), as printed or with velocity and
// position driven by the estimated acceleration. The attitude is an error state on SO(3) (Sola 2017, ch. 5): a rotation
// matrix and, in the state, the turn in B by which it is off; or the paper's roll, pitch and yaw. Fixed sizes, no
// allocation; the covariance's structure is used: a step costs some products of 3 x 3 with 3 x N instead of two of
// N x N.
#pragma once

#include <array>
#include <optional>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::estimation {

/// How velocity comes about. Printed (eqs. 6, 8): a random walk, so that accelerometers never inform it. Coupled: the
/// integral of the acceleration.
enum class KinematicModel { kPrinted, kCoupled };

/// White noise that drives the model, per root of a second.
struct ProcessNoise {
  double jerk{0.05};                ///< m/s^2: moves the acceleration
  double angular_jerk{0.05};        ///< rad/s^2: moves the derivative of the rates
  double velocity{0.1};             ///< m/s: moves the velocity of the printed model; unused in the coupled one
  double accelerometer_bias{1e-4};  ///< m/s^2: moves the first three biases
  double gyro_bias{1e-5};           ///< rad/s: moves the next three
  double log_bias{1e-5};            ///< m/s: moves those of a velocity log
  /// m/s^2, rad/s: move those of accelerometers and gyros beside the package, in their order.
  std::array<double, model::kMostSingles> single_bias{};
};

/// What a step does to small errors: the model's derivative at a point. Kept so that a smoother can go back.
struct Transition {
  /// `on_rotations`: the attitude is an error state, zero at `from` and after the step.
  Transition(const model::KinematicPoint& from, double dt, KinematicModel model, bool on_rotations);

  double dt;
  bool coupled;
  Eigen::Matrix3d R_WB;
  Eigen::Vector3d turn;           ///< rad, in B, over the step
  Eigen::Matrix3d by_angles;      ///< d(R_WB a)/d(angles)
  Eigen::Matrix3d angles_turn;    ///< d(new angles)/d(turn)
  Eigen::Matrix3d angles_angles;  ///< d(new angles)/d(angles)
};

/// N is 18, 24 with the biases of accelerometers and gyros, 27 with those of a velocity log, or 36 with those of
/// accelerometers and gyros beside the inertial package as well.
template <int N>
class KalmanFilter {
 public:
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;

  /// What an observation did.
  struct Outcome {
    bool used{false};
    double innovation{};  ///< less what earlier rows of the same instant have already explained
    double variance{};    ///< predicted, of the innovation
    State gain{State::Zero()};
    /// Normalised innovation squared: 1 on average when noise is as stated.
    [[nodiscard]] double nis() const { return innovation * innovation / variance; }
  };

  /// With roll, pitch and yaw in the state, good to kSteepest.
  void start(const State& x, const State& sigma);
  /// With an error state about R_WB; the angles of `x` are it.
  void start(const State& x, const State& sigma, const Eigen::Matrix3d& R_WB);
  /// Goes on by dt > 0. What updates have turned an error state by first goes into the rotation: turned() then says how
  /// small changes of the old one become changes of the new one.
  void predict(double dt, const ProcessNoise& noise, KinematicModel model);
  /// Something unseen has moved the vehicle, or the estimate is lost: adds to the variances. Between instants only.
  void doubt(const State& sigma) { P_.diagonal() += sigma.cwiseAbs2(); }
  /// The point at which the observations of this instant are linearised; good until the next predict().
  [[nodiscard]] model::KinematicPoint point() const;
  /// Takes in one observation made at point() before any update() of this instant; those already taken count through
  /// `moved`, the sum of their changes. Refused beyond `gate` sigma; an infinite variance changes nothing.
  Outcome update(const model::Observation& observation, double gate, State& moved);
  /// What the last predict() did to the angles before it went on.
  [[nodiscard]] const std::optional<Eigen::Matrix3d>& turned() const { return turned_; }
  /// The rotation about which the angles are an error state; none: they are roll, pitch and yaw.
  [[nodiscard]] const std::optional<Eigen::Matrix3d>& reference() const { return reference_; }
  /// False where the angles are beyond what they can tell: the attitude is lost.
  [[nodiscard]] bool tells_attitude() const;
  /// Of the last predict().
  [[nodiscard]] const std::optional<Transition>& transition() const { return transition_; }
  /// A yaw angle is not folded: it goes on counting turns, so that smoothing is a sum.
  [[nodiscard]] const State& state() const { return x_; }
  [[nodiscard]] const Covariance& covariance() const { return P_; }

 private:
  void fold();

  State x_{State::Zero()};
  Covariance P_{Covariance::Identity()};
  std::optional<Eigen::Matrix3d> reference_;
  std::optional<Eigen::Matrix3d> turned_;
  std::optional<Transition> transition_;
};

/// P F^T in place, columns by columns.
template <int N>
void transport(const Transition& F, Eigen::Matrix<double, N, N>& P);
/// L F in place: the adjoint, for the smoother's way back.
template <int N>
void transport_back(const Transition& F, Eigen::Matrix<double, N, N>& L);
/// F^T l in place.
template <int N>
void transport_back(const Transition& F, Eigen::Matrix<double, N, 1>& l);

extern template class KalmanFilter<model::kKinematicStates>;
extern template class KalmanFilter<model::kInertialStates>;
extern template class KalmanFilter<model::kLoggedStates>;
extern template class KalmanFilter<model::kMostStates>;

}  // namespace fathom::estimation
