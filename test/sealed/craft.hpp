// A vehicle that exists only here: hull, thrusters and what its owner would write about it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "test/sealed/random.hpp"

namespace fathom::sealed {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kGravity = 9.81;

/// Fossen's matrices for a hull whose origin is its centre of mass and whose planes of symmetry make them diagonal.
struct Hull {
  double mass{};                                          ///< kg, dry
  Eigen::Vector3d inertia{Eigen::Vector3d::Zero()};       ///< kg m^2, dry
  Vector6 added{Vector6::Zero()};                         ///< kg, kg m^2: -X_udot ... -N_rdot
  Vector6 linear{Vector6::Zero()};                        ///< positive: -X_u ... -N_r
  Vector6 quadratic{Vector6::Zero()};                     ///< positive: -X_u|u| ... -N_r|r|
  double net_weight{};                                    ///< N, W - B
  Eigen::Vector3d first_moment{Eigen::Vector3d::Zero()};  ///< N m, W r_G - B r_B
};

struct Jet {
  Eigen::Vector3d position, axis;
};

struct Craft {
  std::string family;
  Hull hull;
  double density{};          ///< kg/m^3
  double nominal_voltage{};  ///< V
  Eigen::Vector3d extent;    ///< m, length, width, height
  std::vector<Jet> jets;
  std::array<bool, 6> actuated{};
  Vector6 pace;               ///< m/s, rad/s: typical speed of a trial
  bool states_moments{true};  ///< the owner lets the first moment be identified; else it is zero (trimmed neutral)
  [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> allocation() const;
};

enum class Family { kAft, kCross, kVectored, kTriangle, kHeavy, kSlender };
constexpr int kFamilies = 6;

/// kHeavy and kSlender move in six degrees of freedom, the others in surge, sway, heave and yaw.
[[nodiscard]] Craft draw_craft(Family family, Random& random);

}  // namespace fathom::sealed
