#include "common/joint/normalised.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/model/derivatives/state_matrix.hpp"

namespace fathom::joint {

using model::BaseParameter;

Normalised::Normalised(const model::Vehicle& vehicle, std::vector<BaseParameter> parameters,
                       const ParameterVector& heaviest)
    : parameters_{std::move(parameters)}, dof_{vehicle.dof}, heaviest_{heaviest} {
  const auto number = [&](int parameter) {
    const auto found = std::ranges::find(parameters_, static_cast<BaseParameter>(parameter));
    return found == parameters_.end() ? -1 : static_cast<int>(found - parameters_.begin());
  };
  for (int axis = 0; axis < 6; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    mass_[i] = number(axis);
    linear_[i] = number(model::index(BaseParameter::X_u) + axis);
    quadratic_[i] = number(model::index(BaseParameter::X_uu) + axis);
    if (dof_[i] && mass_[i] < 0) {
      throw InputError("vehicle '" + vehicle.name + "': the joint estimate needs " +
                       std::string{name(static_cast<BaseParameter>(axis))} +
                       " among the parameters, since it moves along that axis; add it, or set estimate: recursive");
    }
  }
  divisor_.reserve(parameters_.size());
  for (const BaseParameter parameter : parameters_) {
    const auto axis = static_cast<std::size_t>(model::axis(parameter));
    divisor_.push_back(dof_[axis] ? mass_[axis] : -1);
  }
}

bool Normalised::clamped(const ParameterVector& phi, int k) const { return phi(k) * heaviest_(k) < 1.0; }

double Normalised::inertia(const ParameterVector& phi, int k) const {
  return clamped(phi, k) ? heaviest_(k) : 1.0 / phi(k);
}

ParameterVector Normalised::physical(const ParameterVector& phi) const {
  ParameterVector theta(phi.size());
  for (int k = 0; k < size(); ++k) {
    const int j = divisor(k);
    theta(k) = j < 0 ? phi(k) : (j == k ? inertia(phi, k) : phi(k) * inertia(phi, j));
  }
  return theta;
}

ParameterMatrix Normalised::physical_slope(const ParameterVector& phi) const {
  ParameterMatrix slope = ParameterMatrix::Zero(phi.size(), phi.size());
  for (int k = 0; k < size(); ++k) {
    const int j = divisor(k);
    if (j < 0) {
      slope(k, k) = 1.0;
      continue;
    }
    const double m = inertia(phi, j), shrinks = clamped(phi, j) ? 0.0 : -m * m;
    if (j != k) slope(k, k) = m;
    slope(k, j) += shrinks * (j == k ? 1.0 : phi(k));
  }
  return slope;
}

Vector6d Normalised::acceleration(const ParameterVector& phi, const Vector6d& nu, const Eigen::Matrix3d& R_WB,
                                  const Vector6d& tau, AccelerationSlope* slope) const {
  const model::BaseRegressor Y = model::motion_regressor(nu, R_WB.row(2).transpose());
  model::BaseTheta theta = model::BaseTheta::Zero();
  const ParameterVector known = physical(phi);
  for (int k = 0; k < size(); ++k) theta[model::index(parameters_[static_cast<std::size_t>(k)])] = known(k);
  const Vector6d force = tau - Y * theta;
  Vector6d mu = Vector6d::Zero();
  for (std::size_t i = 0; i < 6; ++i) {
    if (moves_[i]) mu[static_cast<Eigen::Index>(i)] = phi(mass_[i]);
  }
  if (slope != nullptr) {
    model::Motion motion;
    motion.R_WB = R_WB;
    motion.nu = nu;
    slope->by_motion = mu.asDiagonal() * model::base_force_slope(theta, motion);
    slope->by_parameters.setZero(6, size());
    for (int k = 0; k < size(); ++k) {
      const int j = divisor(k);
      const Vector6d along =
          -mu.cwiseProduct(Y.col(model::index(parameters_[static_cast<std::size_t>(k)])));  // by theta_k
      if (j < 0) {
        slope->by_parameters.col(k) += along;
        continue;
      }
      const double m = inertia(phi, j);
      if (j != k) slope->by_parameters.col(k) += m * along;
      if (!clamped(phi, j)) slope->by_parameters.col(j) -= (m * m * (j == k ? 1.0 : phi(k))) * along;
    }
    for (std::size_t i = 0; i < 6; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      if (moves_[i]) slope->by_parameters(axis, mass_[i]) += force[axis];
    }
  }
  return mu.cwiseProduct(force);
}

double Normalised::quickest(const ParameterVector& phi, const Vector6d& nu) const {
  double rate = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!moves_[i]) continue;
    const double linear = linear_[i] < 0 ? 0.0 : phi(linear_[i]);
    const double quadratic = quadratic_[i] < 0 ? 0.0 : 2.0 * phi(quadratic_[i]) * std::abs(nu[static_cast<int>(i)]);
    rate = std::max(rate, std::abs(linear + quadratic));
  }
  return rate;
}

}  // namespace fathom::joint
