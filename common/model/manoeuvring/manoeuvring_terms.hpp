// Terms of equations of motion: products of velocities past the water, and of rudder angles, that multiply published
// coefficients. Which terms belong together is a standard set (standard_set.hpp).
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>

#include "common/base/spatial.hpp"

namespace fathom::model {

/// What a term is computed from. Of velocities alone where nothing else is stated.
struct TermMotion {
  TermMotion(const Vector6d& relative)
      : nu_r{relative} {}  // NOLINT(google-explicit-constructor): most terms need
                           // no more
  [[nodiscard]] double operator[](Eigen::Index i) const { return nu_r[i]; }

  Vector6d nu_r;    ///< u v w [m/s], p q r [rad/s] past the water
  double rudder{};  ///< rad; positive pushes the stern to starboard
  double plane{};   ///< rad, of stern planes; positive pushes the stern up
  double cruise{};  ///< m/s: the speed about which a set is expanded
};

/// By what a coefficient becomes N or N m per unit of its term.
enum class TermScale {
  kLength,   ///< 1/2 rho L^power
  kDraught,  ///< 1/2 rho L^(power - 1) d
  kPlain     ///< nothing: it is published in SI units
};

struct ManoeuvringTerm {
  std::string_view name;  ///< "X_uu"; "|vw|" stands for sqrt(v^2 + w^2), "U" for the speed through the water
  int axis{};             ///< 0..5 = X Y Z K M N
  int power{};            ///< of the length that makes it dimensionless
  double (*value)(const TermMotion&){};
  TermScale scale{TermScale::kLength};
  bool steers{false};                     ///< it has the angle of a rudder or plane
  int other{-1};                          ///< of a force that turns with the flow: its second axis; -1: none
  double (*beside)(const TermMotion&){};  ///< along that
};

/// By what a set's numbers are made dimensional.
struct TermLengths {
  double length{};   ///< m
  double draught{};  ///< m; 0: no term needs one
  double density{};  ///< kg/m^3, of the water
};

/// What turns a term's number into N or N m per unit of its product.
[[nodiscard]] double manoeuvring_scale(const ManoeuvringTerm& term, const TermLengths& lengths);

/// A coefficient with its published number.
struct ManoeuvringCoefficient {
  const ManoeuvringTerm* term{};
  double value{};
  double error{};  ///< standard error, the same unit; 0: not stated
};

/// Wrench [N, N m] of a set of coefficients.
[[nodiscard]] Vector6d manoeuvring_wrench(std::span<const ManoeuvringCoefficient> coefficients,
                                          const TermMotion& motion, const TermLengths& lengths);

}  // namespace fathom::model
