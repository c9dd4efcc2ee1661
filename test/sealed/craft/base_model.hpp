// The base model as docs/model.md states it, linear in its numbers, and its own best fit to true accelerations: what an
// effect leaves beyond that is its size.
#pragma once

#include "test/sealed/dives/dive.hpp"

namespace fathom::sealed {

/// Names of the base numbers in which a vehicle's file lets a diagnosis look, in a fixed order.
[[nodiscard]] std::vector<std::string> base_names(const Craft& craft);
/// Their true values.
[[nodiscard]] Eigen::VectorXd base_values(const Craft& craft, const Hull& hull);
/// A hull with these values; what they do not determine (dry mass, moments that are not listed) is kept.
[[nodiscard]] Hull hull_with(const Craft& craft, Hull hull, const Eigen::VectorXd& values);
/// Y with Y(nu_dot, nu, down) values = tau, one row per degree of freedom of `craft`.
void base_rows(const Craft& craft, const Vector6& nu_dot, const Vector6& nu, const Eigen::Vector3d& down,
               Eigen::Ref<Eigen::MatrixXd> rows);

struct BaseFit {
  Eigen::VectorXd values;
  Vector6 residual{Vector6::Zero()};  ///< RMS per driven axis, N, N m
  Vector6 applied{Vector6::Zero()};   ///< RMS of the commanded wrench
};

/// Least squares on noise-free signals as the instruments understand them, axes weighted by the applied wrench.
[[nodiscard]] BaseFit fit_base(const Craft& craft, std::span<const Dive> runs);

/// Residual that `with` adds to `without`, as a share of the applied wrench, root mean square over the driven axes.
[[nodiscard]] double added_share(const Craft& craft, const BaseFit& with, const BaseFit& without);

}  // namespace fathom::sealed
