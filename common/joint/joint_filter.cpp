#include "common/joint/joint_filter.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"

namespace fathom::joint {
namespace {

constexpr double kLargestStep = 0.5;    // of a decay within a step of the fourth order: right to 5e-4
constexpr int kMostSteps = 4;           // within one prediction: wild estimates shall not take for ever
constexpr double kFreeSpeed = 0.5;      // m/s^2 in one second: axes that only follow what is measured
constexpr double kFreeRate = 5.0;       // rad/s^2 in one second, likewise
constexpr double kPreciseBeyond = 1e3;  // prior over noise beyond which the update is Joseph's to the letter

}  // namespace

JointFilter::JointFilter(const Normalised& model, const JointNoise& noise, const ParameterVector& mean,
                         const ParameterVector& sigma)
    : model_{model}, noise_{noise} {
  const Eigen::Index n = part::kParameters + model.size();
  x_ = JointVector::Zero(n);
  x_.tail(model.size()) = mean;
  P_ = JointMatrix::Zero(n, n);
  P_.diagonal().tail(model.size()) = sigma.cwiseAbs2();
  P_(part::kScale, part::kScale) = noise.scale * noise.scale;
  P_(part::kHeight, part::kHeight) = noise.height * noise.height;
  P_.diagonal().segment<3>(part::kOffset) = noise.offset.cwiseAbs2();
  P_.diagonal().segment<3>(part::kTurned).setConstant(noise.turned * noise.turned);
}

void JointFilter::start(const Eigen::Vector3d& p_WB, const Vector6d& nu, const Vector6d& sigma_p_v,
                        double sigma_rates) {
  constexpr int kLost = part::kScale;
  P_.topRows(kLost).setZero();
  P_.leftCols(kLost).setZero();
  x_.head(kLost).setZero();
  x_.segment<3>(part::kPosition) = p_WB;
  x_.segment<6>(part::kNu) = nu;
  P_.diagonal().segment<6>(part::kPosition) = sigma_p_v.cwiseAbs2();
  P_.diagonal().segment<3>(part::kNu + 3).setConstant(sigma_rates * sigma_rates);
  P_.diagonal().segment<3>(part::kAttitude).setConstant(noise_.attitude * noise_.attitude);
  P_.diagonal().segment<3>(part::kBias).setConstant(noise_.bias_prior * noise_.bias_prior);
}

ParameterMatrix JointFilter::parameter_covariance() const { return P_.bottomRightCorner(model_.size(), model_.size()); }

void JointFilter::hold(int parameter, bool held) {
  held_[static_cast<std::size_t>(parameter)] = held;
  count_still();
}

bool JointFilter::still(int parameter) const {
  const auto k = static_cast<std::size_t>(parameter);
  const int axis = model::axis(model_.parameters()[k]);
  return held_[k] || !(model_.simulated(axis) ? model_.moves(axis) : rest_taught_);
}

void JointFilter::count_still() {
  any_still_ = false;
  for (int k = 0; k < model_.size(); ++k) any_still_ = any_still_ || still(k);
}

bool JointFilter::sane() const {
  if (!x_.allFinite() || !P_.diagonal().allFinite() || P_.diagonal().minCoeff() < 0.0) return false;
  for (int axis = 0; axis < 6; ++axis) {
    if (model_.moves(axis) && model_.clamped(parameters(), model_.inertia_of(axis))) return false;
  }
  return true;
}

void JointFilter::teach(int axis, const ParameterVector& mean, const ParameterMatrix& covariance) {
  model_.move(axis);
  std::array<int, model::kBaseParameterCount> own{};
  Eigen::Index n = 0;
  for (int k = 0; k < model_.size(); ++k) {
    if (model::axis(model_.parameters()[static_cast<std::size_t>(k)]) == axis) own[static_cast<std::size_t>(n++)] = k;
  }
  const int inertia = model_.inertia_of(axis);
  ParameterMatrix slope = ParameterMatrix::Zero(n, n), theirs(n, n);  // d phi / d theta
  for (Eigen::Index i = 0; i < n; ++i) {
    const int k = own[static_cast<std::size_t>(i)];
    const double m = mean(inertia);
    x_(part::kParameters + k) = (k == inertia ? 1.0 : mean(k)) / m;
    for (Eigen::Index j = 0; j < n; ++j) {
      const int l = own[static_cast<std::size_t>(j)];
      theirs(i, j) = covariance(k, l);
      if (l == inertia) slope(i, j) = -(k == inertia ? 1.0 : mean(k)) / (m * m);
    }
    if (k != inertia) slope(i, i) = 1.0 / m;
    P_.row(part::kParameters + k).setZero();
    P_.col(part::kParameters + k).setZero();
  }
  const ParameterMatrix known = slope * theirs * slope.transpose();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      P_(part::kParameters + own[static_cast<std::size_t>(i)], part::kParameters + own[static_cast<std::size_t>(j)]) =
          known(i, j);
  }
  count_still();
}

void JointFilter::teach_rest(const ParameterVector& mean, const ParameterMatrix& covariance) {
  for (int k = 0; k < model_.size(); ++k) {
    if (model_.simulated(model::axis(model_.parameters()[static_cast<std::size_t>(k)]))) continue;
    const Eigen::Index at = part::kParameters + k;
    x_(at) = mean(k);
    P_.row(at).setZero();
    P_.col(at).setZero();
    P_(at, at) = covariance(k, k);
  }
  rest_taught_ = true;
  count_still();
}

bool JointFilter::restore(const ParameterVector& mean, const ParameterMatrix& covariance) {
  const Eigen::Index n = model_.size();
  if (mean.size() != n || covariance.rows() != n || covariance.cols() != n || !mean.allFinite() ||
      !covariance.allFinite() || !(covariance.diagonal().minCoeff() >= 0.0))
    return false;
  P_.rightCols(n).setZero();
  P_.bottomRows(n).setZero();
  x_.tail(n) = mean;
  P_.bottomRightCorner(n, n) = 0.5 * (covariance + covariance.transpose());
  for (int axis = 0; axis < 6; ++axis) model_.move(axis);
  rest_taught_ = true;
  count_still();
  return true;
}

// The derivative of the discrete step itself, along its own substeps, not of the differential equation.
void JointFilter::move(double dt, const Eigen::Matrix3d& R_from, const Eigen::Matrix3d& R_middle,
                       const Eigen::Matrix3d& R_to, const Vector6d& tau, Transition& F) {
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMostStates>;
  const Eigen::Index n = size();
  const int parameters = model_.size();
  const ParameterVector phi = this->parameters();
  const Eigen::Matrix3d turn = quaternion_from_rotation_vector(x_.segment<3>(part::kAttitude)).toRotationMatrix();
  const Eigen::Matrix3d R = R_middle * turn;
  Vector6d nu = this->nu();
  const Eigen::Vector3d v_before = nu.head<3>();
  const double quick = model_.quickest(phi, nu);
  const int steps = std::clamp(static_cast<int>(std::ceil(dt * quick / kLargestStep)), 1, kMostSteps);
  const double h = dt / steps;
  Rows S = Rows::Zero(6, n);
  S.middleCols<6>(part::kNu).setIdentity();
  AccelerationSlope slope;
  Vector6d a, sum;
  Rows by, sums;  // their derivatives
  const auto feel = [&](const Vector6d& at, const Rows& moved) {
    a = model_.acceleration(phi, at, R, tau, &slope);
    by.noalias() = slope.by_motion.rightCols<6>() * moved;
    by.middleCols<3>(part::kAttitude) += slope.by_motion.leftCols<3>();
    by.rightCols(parameters) += slope.by_parameters;
  };
  for (int k = 0; k < steps; ++k) {  // Runge and Kutta's of the fourth order
    feel(nu, S);
    sum = a;
    sums = by;
    feel(nu + 0.5 * h * a, S + 0.5 * h * by);
    sum += 2.0 * a;
    sums += 2.0 * by;
    feel(nu + 0.5 * h * a, S + 0.5 * h * by);
    sum += 2.0 * a;
    sums += 2.0 * by;
    feel(nu + h * a, S + h * by);
    nu += h / 6.0 * (sum + a);
    S += h / 6.0 * (sums + by);
  }
  const Eigen::Matrix3d from = R_from * turn, to = R_to * turn;
  F.setZero(9, n);
  F.bottomRows<6>() = S;
  F.topRows<3>() = 0.5 * dt * to * S.topRows<3>();
  F.middleCols<3>(part::kNu).topRows<3>() += 0.5 * dt * from;
  F.middleCols<3>(part::kAttitude).topRows<3>() -=
      0.5 * dt * (from * skew(v_before) + to * skew(Eigen::Vector3d{nu.head<3>()}));
  F.topLeftCorner<3, 3>().setIdentity();
  x_.segment<3>(part::kPosition) += 0.5 * dt * (from * v_before + to * nu.head<3>());
  x_.segment<6>(part::kNu) = nu;
}

void JointFilter::predict(double dt, const Eigen::Matrix3d& R_from, const Eigen::Matrix3d& R_middle,
                          const Eigen::Matrix3d& R_to, const Vector6d& tau) {
  Transition F;
  move(dt, R_from, R_middle, R_to, tau, F);
  const Eigen::Index n = size();
  Transition T(9, n);
  T.noalias() = F * P_;
  P_.topRows<9>() = T;
  P_.bottomLeftCorner(n - 9, 9) = T.rightCols(n - 9).transpose();
  const Eigen::Matrix<double, 9, 9> moving = T * F.transpose();
  P_.topLeftCorner<9, 9>() = 0.5 * (moving + moving.transpose());
  diffuse(dt);
}

void JointFilter::diffuse(double dt) {
  for (int axis = 0; axis < 6; ++axis) {
    const double free = axis < 3 ? kFreeSpeed : kFreeRate, lacks = axis < 3 ? noise_.acceleration : noise_.turning;
    const double density = model_.moves(axis) ? lacks : free;
    P_(part::kNu + axis, part::kNu + axis) += density * density * dt;
  }
  P_.diagonal().segment<3>(part::kBias).array() += noise_.bias_walk * noise_.bias_walk * dt;
  const double keep = std::exp(-dt / noise_.attitude_memory);
  P_.middleRows<3>(part::kAttitude) *= keep;
  P_.middleCols<3>(part::kAttitude) *= keep;
  P_.diagonal().segment<3>(part::kAttitude).array() += noise_.attitude * noise_.attitude * (1.0 - keep * keep);
  x_.segment<3>(part::kAttitude) *= keep;
}

int JointFilter::update(std::span<JointRow> rows, double gate) {
  JointVector moved = JointVector::Zero(size());
  int taken = 0;
  for (JointRow& row : rows) {
    const double innovation = row.innovation - row.h.dot(moved);
    row.score = 0.0;
    if (take(row, innovation, gate, moved)) ++taken;
  }
  return taken;
}

bool JointFilter::take(JointRow& row, double innovation, double gate, JointVector& moved) {
  const Eigen::Index n = size();
  const JointVector prior = row.of_motion
                                ? JointVector{P_.leftCols<part::kParameters>() * row.h.head<part::kParameters>()}
                                : JointVector{P_ * row.h};
  const bool shares = !row.shared.isZero(0.0);
  JointVector with = prior;  // covariance of the state with the innovation
  with.segment<6>(part::kNu) += row.shared;
  const double known = row.h.dot(prior);
  const double variance = known + 2.0 * row.h.segment<6>(part::kNu).dot(row.shared) + row.variance;
  if (!std::isfinite(variance) || !(variance > 0.0) || !std::isfinite(innovation)) return false;
  if (innovation * innovation > gate * gate * variance) return false;
  row.score = innovation / std::sqrt(variance);
  JointVector gain = with / variance;
  if (any_still_) {
    for (int k = 0; k < model_.size(); ++k) {
      if (!still(k)) continue;
      // What is held is the number in SI: its share of an inertia that goes on being learnt follows that one.
      const int j = model_.divisor(k);
      const bool follows = j >= 0 && j != k && !still(j);
      const Eigen::Index at = part::kParameters + k, by = part::kParameters + j;
      gain(at) = follows && x_(by) > 0.0 ? x_(at) / x_(by) * gain(by) : 0.0;
    }
  }
  if (!any_still_ && known < kPreciseBeyond * row.variance) {
    P_.noalias() -= gain * with.transpose();
  } else {  // (I - k h') P (I - k h')' + k r k', and what noise and state share
    P_.noalias() -= gain * prior.transpose();
    const JointVector again = P_ * row.h;
    P_.noalias() -= again * gain.transpose();
    P_.noalias() += row.variance * gain * gain.transpose();
    if (shares) {
      JointVector rest = JointVector::Zero(n);
      rest.segment<6>(part::kNu) = row.shared;
      rest -= gain * row.h.segment<6>(part::kNu).dot(row.shared);
      P_.noalias() -= rest * gain.transpose();
      P_.noalias() -= gain * rest.transpose();
    }
  }
  P_.triangularView<Eigen::StrictlyUpper>() = P_.transpose();
  const JointVector change = gain * innovation;
  x_ += change;
  moved += change;
  return true;
}

}  // namespace fathom::joint
