#include "common/model/priors/expected_inertia.hpp"

#include <algorithm>
#include <array>

#include "common/model/priors/wide_prior.hpp"

namespace fathom::model {
namespace {

constexpr std::array kLbv150{9.7532, 8.6636, 10.898};  // kg: m_X, m_Y, m_Z of Table 1.1

}  // namespace

Vector6d expected_inertia(const Vehicle& vehicle) {
  Vector6d expected = Vector6d::Zero();
  for (int axis = 0; axis < 6; ++axis) {
    const BaseParameter parameter = base_parameters()[static_cast<std::size_t>(axis)];
    const auto found = std::ranges::find(vehicle.parameters, name(parameter));
    if (found != vehicle.parameters.end()) {
      expected[axis] = vehicle.priors.at(static_cast<std::size_t>(found - vehicle.parameters.begin())).mean;
    } else if (vehicle.mass > 0.0) {
      expected[axis] = wide_prior(parameter, vehicle).mean;
    }
  }
  return expected;
}

Vector6d inertia_beside_lbv150(const Vehicle& vehicle) {
  const Vector6d expected = expected_inertia(vehicle);
  Vector6d ratio = Vector6d::Ones();
  for (std::size_t i = 0; i < kLbv150.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (expected[axis] > 0.0) ratio[axis] = expected[axis] / kLbv150[i];
  }
  return ratio;
}

}  // namespace fathom::model
