// A vehicle for tests of the joint estimate: LBV150 or BlueROV2 with its file's numbers as the truth, and a state that
// is nowhere special.
#pragma once

#include <algorithm>
#include <vector>

#include "common/joint/joint_filter.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::joint::example {

inline std::vector<model::BaseParameter> columns(const model::Vehicle& vehicle) {
  std::vector<model::BaseParameter> all;
  for (const std::string& name : vehicle.parameters) all.push_back(*model::parameter_from_name(name));
  return all;
}

inline ParameterVector numbers(const model::Vehicle& vehicle) {
  ParameterVector theta(static_cast<Eigen::Index>(vehicle.priors.size()));
  for (std::size_t k = 0; k < vehicle.priors.size(); ++k) theta(static_cast<Eigen::Index>(k)) = vehicle.priors[k].mean;
  return theta;
}

/// All axes moved by the model.
inline Normalised moving(const model::Vehicle& vehicle) {
  const ParameterVector theta = numbers(vehicle);
  Normalised model{vehicle, columns(vehicle), ParameterVector{20.0 * theta.cwiseAbs()}};
  for (int axis = 0; axis < 6; ++axis) model.move(axis);
  return model;
}

inline ParameterVector normalised(const Normalised& model, const ParameterVector& theta) {
  ParameterVector phi = theta;
  for (int k = 0; k < model.size(); ++k) {
    const int j = model.divisor(k);
    if (j >= 0) phi(k) = (j == k ? 1.0 : theta(k)) / theta(j);
  }
  return phi;
}

/// A filter that knows the parameters to a tenth and moves.
inline JointFilter filter(const model::Vehicle& vehicle, const JointNoise& noise = {}) {
  const Normalised model = moving(vehicle);
  const ParameterVector phi = normalised(model, numbers(vehicle));
  JointFilter filter{model, noise, phi, ParameterVector{0.1 * phi.cwiseAbs().array() + 1e-3}};
  const ParameterVector sigma = 0.1 * numbers(vehicle).cwiseAbs().array() + 1e-3;
  const ParameterMatrix covariance = sigma.cwiseAbs2().asDiagonal();
  for (int axis = 0; axis < 6; ++axis) {
    if (model.simulated(axis)) filter.teach(axis, numbers(vehicle), covariance);
  }
  filter.teach_rest(numbers(vehicle), covariance);
  Vector6d nu;
  nu << 0.3, -0.2, 0.15, 0.1, -0.15, 0.4;
  filter.start({0.4, -0.3, 0.8}, nu, Vector6d::Constant(0.02), 0.02);
  return filter;
}

}  // namespace fathom::joint::example
