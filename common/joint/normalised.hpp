// The base model divided by its inertias: with 1/m in place of m and d/m in place of d, accelerations are linear in
// nearly all of the numbers, so that a Kalman filter may begin without knowing what a vehicle weighs.
//   nu_dot_i = mu_i (tau_i - (Y theta)_i),  theta_mass = 1/mu,  theta_k = phi_k/mu of its axis
#pragma once

#include <array>
#include <vector>

#include "common/identification/rows.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/regressor.hpp"

namespace fathom::joint {

using identification::ParameterMatrix;
using identification::ParameterVector;

/// d(nu_dot)/d(what it depends on); rows of axes that do not move by the model are zero.
struct AccelerationSlope {
  Eigen::Matrix<double, 6, 9> by_motion;  ///< [attitude e, R_WB exp(skew(e)); nu]
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, model::kBaseParameterCount> by_parameters;
};

class Normalised {
 public:
  /// InputError when a simulated degree of freedom has no inertia among the parameters. `lightest`: kg, kg m^2, per
  /// parameter that is an inertia; 1/mu is `heaviest` at most.
  Normalised(const model::Vehicle& vehicle, std::vector<model::BaseParameter> parameters,
             const ParameterVector& heaviest);

  [[nodiscard]] int size() const { return static_cast<int>(parameters_.size()); }
  [[nodiscard]] const std::vector<model::BaseParameter>& parameters() const { return parameters_; }
  /// Number of the inertia by which a parameter is divided; itself where it is an inertia; -1: by none, since its axis
  /// is not simulated.
  [[nodiscard]] int divisor(int k) const { return divisor_[static_cast<std::size_t>(k)]; }
  /// Whether the model moves this axis. At first it moves none: an axis whose inertia nobody knows is better followed.
  [[nodiscard]] bool moves(int axis) const { return moves_[static_cast<std::size_t>(axis)]; }
  /// From now on it does, where it is a simulated degree of freedom.
  void move(int axis) { moves_[static_cast<std::size_t>(axis)] = dof_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] bool simulated(int axis) const { return dof_[static_cast<std::size_t>(axis)]; }
  /// Number of the inertia of an axis; -1: none.
  [[nodiscard]] int inertia_of(int axis) const { return mass_[static_cast<std::size_t>(axis)]; }

  /// An inertia beyond `heaviest`, which is then taken in its place.
  [[nodiscard]] bool clamped(const ParameterVector& phi, int k) const;
  /// In SI.
  [[nodiscard]] ParameterVector physical(const ParameterVector& phi) const;
  /// d physical / d phi.
  [[nodiscard]] ParameterMatrix physical_slope(const ParameterVector& phi) const;

  /// nu_dot [m/s^2, rad/s^2] under tau [N, N m]; where `slope` is given, its derivatives.
  [[nodiscard]] Vector6d acceleration(const ParameterVector& phi, const Vector6d& nu, const Eigen::Matrix3d& R_WB,
                                      const Vector6d& tau, AccelerationSlope* slope = nullptr) const;
  /// 1/s: how quickly the quickest axis settles at this speed.
  [[nodiscard]] double quickest(const ParameterVector& phi, const Vector6d& nu) const;

 private:
  [[nodiscard]] double inertia(const ParameterVector& phi, int k) const;

  std::vector<model::BaseParameter> parameters_;
  std::vector<int> divisor_;
  std::array<int, 6> mass_{};  // parameter of each axis's inertia; -1: none
  std::array<int, 6> linear_{}, quadratic_{};
  std::array<bool, 6> dof_{}, moves_{};
  ParameterVector heaviest_;
};

}  // namespace fathom::joint
