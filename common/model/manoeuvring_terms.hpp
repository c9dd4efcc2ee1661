// Terms of the standard submarine equations (Gertler and Hagen 1967, Feldman 1979): products of relative velocities
// that multiply hydrodynamic derivatives. Pereira and Duncan's eqs. 2 and 5 and their Tables 1 to 6 are among them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/spatial.hpp"

namespace fathom::model {

struct ManoeuvringTerm {
  std::string_view name;  ///< "X_uu"; "|vw|" stands for sqrt(v^2 + w^2), "U" for the speed through the water
  int axis{};             ///< 0..5 = X Y Z K M N
  int power{};            ///< of the length that makes it dimensionless: coefficient = 1/2 rho L^power * its number
  double (*value)(const Vector6d& nu_r);
};

/// All of them, axis by axis.
[[nodiscard]] std::span<const ManoeuvringTerm> manoeuvring_terms();
/// Nothing when no term has this name.
[[nodiscard]] const ManoeuvringTerm* find_manoeuvring_term(std::string_view name);
/// What turns the dimensionless number of a term into N or N m per unit of its product.
[[nodiscard]] double manoeuvring_scale(const ManoeuvringTerm& term, double length, double density);

/// A derivative with its dimensionless number.
struct ManoeuvringCoefficient {
  const ManoeuvringTerm* term{};
  double value{};
  double error{};  ///< standard error, the same unit; 0: not stated
};

/// Wrench [N, N m] of a set of derivatives at relative velocity nu_r.
[[nodiscard]] Vector6d manoeuvring_wrench(std::span<const ManoeuvringCoefficient> coefficients, const Vector6d& nu_r,
                                          double length, double density);

}  // namespace fathom::model
