#include "common/estimation/online/kalman_filter.hpp"

#include <cmath>

namespace fathom::estimation {
namespace {

namespace at = model::at;

constexpr double kMostTurn = 1.0;       // rad, of one step: beyond, what the rates were is not known
constexpr double kMostCorrected = 6.0;  // rad, of one instant: at a whole turn a rotation vector is singular
constexpr double kPreciseBeyond =
    1e8;  // variance before over noise: from here on the plain update loses too many digits

/// Adds what white noise of density q does to a chain x' = rate, rate' = slope, slope' = noise in the slope's frame;
/// X and V turn it into the frames of x and rate.
template <int N>
void add_chain(Eigen::Matrix<double, N, N>& P, int x, int rate, int slope, double q, double dt,
               const Eigen::Matrix3d& X, const Eigen::Matrix3d& V) {
  const double dt2 = dt * dt, dt3 = dt2 * dt;
  P.template block<3, 3>(x, x) += (q * dt3 * dt2 / 20.0) * X * X.transpose();
  P.template block<3, 3>(rate, x) += (q * dt2 * dt2 / 8.0) * V * X.transpose();
  P.template block<3, 3>(slope, x) += (q * dt3 / 6.0) * X.transpose();
  P.template block<3, 3>(rate, rate) += (q * dt3 / 3.0) * V * V.transpose();
  P.template block<3, 3>(slope, rate) += (q * dt2 / 2.0) * V.transpose();
  P.template block<3, 3>(slope, slope).diagonal().array() += q * dt;
}

/// Only the lower triangle has been kept up; the upper one follows.
template <int N>
void mirror(Eigen::Matrix<double, N, N>& P) {
  for (int column = 1; column < N; ++column) {
    for (int row = 0; row < column; ++row) P(row, column) = P(column, row);
  }
}

}  // namespace

Transition::Transition(const model::KinematicPoint& from, double step, KinematicModel model, bool on_rotations)
    : dt{step},
      coupled{model == KinematicModel::kCoupled},
      R_WB{from.R_WB},
      turn{dt * from.group(at::kRates) + 0.5 * dt * dt * from.group(at::kRateSlopes)},
      by_angles{from.turned_out(from.group(at::kAcceleration))} {
  if (on_rotations) {  // exp(d) exp(turn + e) = exp(turn) exp(exp(turn)' d + J e)
    angles_angles = quaternion_from_rotation_vector(turn).toRotationMatrix().transpose();
    angles_turn = right_jacobian(turn);
    return;
  }
  const Eigen::Vector3d euler = from.group(at::kAngles);
  const double sr = std::sin(euler.x()), cr = std::cos(euler.x()), cp = std::cos(euler.y()), tp = std::tan(euler.y());
  angles_turn << 1.0, sr * tp, cr * tp, 0.0, cr, -sr, 0.0, sr / cp, cr / cp;
  const double across = sr * turn.y() + cr * turn.z(), along = cr * turn.y() - sr * turn.z();
  angles_angles << 1.0 + along * tp, across / (cp * cp), 0.0,  //
      -across, 1.0, 0.0,                                       //
      along / cp, across * tp / cp, 1.0;
}

template <int N>
void transport(const Transition& F, Eigen::Matrix<double, N, N>& P) {
  const double dt = F.dt;
  auto position = P.template middleCols<3>(at::kPosition);
  auto velocity = P.template middleCols<3>(at::kVelocity);
  auto angles = P.template middleCols<3>(at::kAngles);
  auto acceleration = P.template middleCols<3>(at::kAcceleration);
  auto rates = P.template middleCols<3>(at::kRates);
  auto slopes = P.template middleCols<3>(at::kRateSlopes);
  Eigen::Matrix<double, N, 3> part;
  position += dt * velocity;
  if (F.coupled) {
    part.noalias() = acceleration * F.R_WB.transpose();
    part.noalias() += angles * F.by_angles.transpose();
    position += (0.5 * dt * dt) * part;
    velocity += dt * part;
  }
  part.noalias() = angles * F.angles_angles.transpose();
  part.noalias() += (dt * rates + (0.5 * dt * dt) * slopes) * F.angles_turn.transpose();
  angles = part;
  rates += dt * slopes;
}

template <int N>
void transport_back(const Transition& F, Eigen::Matrix<double, N, N>& L) {
  const double dt = F.dt;
  auto position = L.template middleCols<3>(at::kPosition);
  auto velocity = L.template middleCols<3>(at::kVelocity);
  auto angles = L.template middleCols<3>(at::kAngles);
  auto acceleration = L.template middleCols<3>(at::kAcceleration);
  auto rates = L.template middleCols<3>(at::kRates);
  auto slopes = L.template middleCols<3>(at::kRateSlopes);
  Eigen::Matrix<double, N, 3> part;
  part.noalias() = angles * F.angles_turn;
  slopes += dt * rates + (0.5 * dt * dt) * part;
  rates += dt * part;
  part.noalias() = angles * F.angles_angles;
  angles = part;
  if (F.coupled) {
    part = (0.5 * dt * dt) * position + dt * velocity;
    angles.noalias() += part * F.by_angles;
    acceleration.noalias() += part * F.R_WB;
  }
  velocity += dt * position;
}

template <int N>
void transport_back(const Transition& F, Eigen::Matrix<double, N, 1>& l) {
  const double dt = F.dt;
  auto group = [&l](int begin) { return l.template segment<3>(begin); };
  const Eigen::Vector3d turned = F.angles_turn.transpose() * group(at::kAngles);
  group(at::kRateSlopes) += dt * group(at::kRates) + (0.5 * dt * dt) * turned;
  group(at::kRates) += dt * turned;
  const Eigen::Vector3d angles = F.angles_angles.transpose() * group(at::kAngles);
  group(at::kAngles) = angles;
  if (F.coupled) {
    const Eigen::Vector3d part = (0.5 * dt * dt) * group(at::kPosition) + dt * group(at::kVelocity);
    group(at::kAngles) += F.by_angles.transpose() * part;
    group(at::kAcceleration) += F.R_WB.transpose() * part;
  }
  const Eigen::Vector3d step = dt * group(at::kPosition);
  group(at::kVelocity) += step;
}

template <int N>
void KalmanFilter<N>::start(const State& x, const State& sigma) {
  x_ = x;
  P_ = sigma.cwiseAbs2().asDiagonal();
  reference_.reset();
  turned_.reset();
  transition_.reset();
}

template <int N>
void KalmanFilter<N>::start(const State& x, const State& sigma, const Eigen::Matrix3d& R_WB) {
  start(x, sigma);
  reference_ = R_WB;
}

template <int N>
bool KalmanFilter<N>::tells_attitude() const {
  const Eigen::Vector3d angles = x_.template segment<3>(at::kAngles);
  if (!reference_) return std::abs(angles.y()) < model::kSteepest;
  return angles.norm() < kMostCorrected && (!transition_ || transition_->turn.norm() < kMostTurn);
}

template <int N>
model::KinematicPoint KalmanFilter<N>::point() const {
  model::KinematicVector x = model::KinematicVector::Zero();
  x.head<N>() = x_;
  return model::KinematicPoint{x, reference_};
}

template <int N>
void KalmanFilter<N>::fold() {
  const Eigen::Vector3d angles = x_.template segment<3>(at::kAngles);
  if (angles.isZero(0.0)) return;
  turned_ = right_jacobian(angles);
  reference_ = point().R_WB;
  x_.template segment<3>(at::kAngles).setZero();
  const Eigen::Matrix<double, N, 3> columns = P_.template middleCols<3>(at::kAngles) * turned_->transpose();
  P_.template middleCols<3>(at::kAngles) = columns;
  const Eigen::Matrix<double, 3, N> rows = *turned_ * P_.template middleRows<3>(at::kAngles);
  P_.template middleRows<3>(at::kAngles) = rows;
}

template <int N>
void KalmanFilter<N>::predict(double dt, const ProcessNoise& noise, KinematicModel model) {
  turned_.reset();
  if (reference_) fold();
  const model::KinematicPoint from = point();
  const Transition F{from, dt, model, reference_.has_value()};
  const auto group = [this](int begin) { return x_.template segment<3>(begin); };
  group(at::kPosition) += dt * group(at::kVelocity);
  if (F.coupled) {
    const Eigen::Vector3d a_W = F.R_WB * group(at::kAcceleration);
    group(at::kPosition) += (0.5 * dt * dt) * a_W;
    group(at::kVelocity) += dt * a_W;
  }
  if (reference_) {
    *reference_ = (*reference_ * F.angles_angles.transpose()).eval();
  } else {
    group(at::kAngles) += F.angles_turn * F.turn;
  }
  group(at::kRates) += dt * group(at::kRateSlopes);

  transport<N>(F, P_);
  P_.transposeInPlace();
  transport<N>(F, P_);

  const auto square = [](double value) { return value * value; };
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  static_assert(at::kPosition < at::kVelocity && at::kVelocity < at::kAcceleration && at::kAngles < at::kRates &&
                at::kRates < at::kRateSlopes);  // the chains are added below the diagonal
  if (F.coupled) {
    add_chain<N>(P_, at::kPosition, at::kVelocity, at::kAcceleration, square(noise.jerk), dt, F.R_WB, F.R_WB);
  } else {
    const double q = square(noise.velocity);
    P_.template block<3, 3>(at::kPosition, at::kPosition).diagonal().array() += q * dt * dt * dt / 3.0;
    P_.template block<3, 3>(at::kVelocity, at::kPosition).diagonal().array() += q * dt * dt / 2.0;
    P_.template block<3, 3>(at::kVelocity, at::kVelocity).diagonal().array() += q * dt;
    P_.template block<3, 3>(at::kAcceleration, at::kAcceleration).diagonal().array() += square(noise.jerk) * dt;
  }
  add_chain<N>(P_, at::kAngles, at::kRates, at::kRateSlopes, square(noise.angular_jerk), dt, F.angles_turn, I);
  if constexpr (N > model::kKinematicStates) {
    P_.diagonal().template segment<3>(at::kBias).array() += square(noise.accelerometer_bias) * dt;
    P_.diagonal().template segment<3>(at::kBias + 3).array() += square(noise.gyro_bias) * dt;
  }
  if constexpr (N > model::kInertialStates)
    P_.diagonal().template segment<3>(at::kLogBias).array() += square(noise.log_bias) * dt;
  if constexpr (N > model::kLoggedStates) {
    for (std::size_t i = 0; i < noise.single_bias.size(); ++i)
      P_.diagonal()[at::kSingleBias + static_cast<Eigen::Index>(i)] += square(noise.single_bias[i]) * dt;
  }
  mirror<N>(P_);
  transition_ = F;
}

template <int N>
typename KalmanFilter<N>::Outcome KalmanFilter<N>::update(const model::Observation& observation, double gate,
                                                          State& moved) {
  Outcome outcome;
  const auto row = observation.row.template head<N>();
  State w = State::Zero();
  double explained = 0.0;
  for (int i = 0; i < N / 3; ++i) {
    if ((observation.groups >> static_cast<unsigned>(i) & 1U) == 0) continue;
    w.noalias() += P_.template middleCols<3>(3 * i) * row.template segment<3>(3 * i);
    explained += row.template segment<3>(3 * i).dot(moved.template segment<3>(3 * i));
  }
  const double prior = row.dot(w);
  outcome.innovation = observation.innovation - explained;
  outcome.variance = prior + observation.variance;
  if (!std::isfinite(outcome.variance) || !(outcome.variance > 0.0)) return outcome;
  if (outcome.innovation * outcome.innovation > gate * gate * outcome.variance) return outcome;
  outcome.used = true;
  outcome.gain = w * (1.0 / outcome.variance);
  if (prior < kPreciseBeyond * observation.variance) {
    const State scaled = w * (1.0 / std::sqrt(outcome.variance));
    P_.noalias() -= scaled * scaled.transpose();
  } else {  // Joseph: (I - k h') P (I - k h')' + k R k'
    Covariance left = P_ - outcome.gain * w.transpose();
    const State again = left * row;
    left -= again * outcome.gain.transpose();
    P_ = left + observation.variance * outcome.gain * outcome.gain.transpose();
    mirror<N>(P_);
  }
  const State change = outcome.gain * outcome.innovation;
  x_ += change;
  moved += change;
  return outcome;
}

template class KalmanFilter<model::kKinematicStates>;
template class KalmanFilter<model::kInertialStates>;
template class KalmanFilter<model::kLoggedStates>;
template class KalmanFilter<model::kMostStates>;
template void transport_back<model::kKinematicStates>(const Transition&, Eigen::Matrix<double, 18, 18>&);
template void transport_back<model::kInertialStates>(const Transition&, Eigen::Matrix<double, 24, 24>&);
template void transport_back<model::kLoggedStates>(const Transition&, Eigen::Matrix<double, 27, 27>&);
template void transport_back<model::kMostStates>(const Transition&, Eigen::Matrix<double, 36, 36>&);
template void transport_back<model::kKinematicStates>(const Transition&, Eigen::Matrix<double, 18, 1>&);
template void transport_back<model::kInertialStates>(const Transition&, Eigen::Matrix<double, 24, 1>&);
template void transport_back<model::kLoggedStates>(const Transition&, Eigen::Matrix<double, 27, 1>&);
template void transport_back<model::kMostStates>(const Transition&, Eigen::Matrix<double, 36, 1>&);

}  // namespace fathom::estimation
