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

/// What drives it: a force as told; a propeller that loses thrust as it advances; a fin that lifts with the square of
/// the speed past it; a weight that is gained, or moved along the hull. Told are forces [N]: of a propeller at rest, of
/// a fin at its reference speed, a weight gained, and the moment [N m] of a weight moved when level.
enum class Drive { kForce, kPropeller, kFin, kGained, kMoved };

struct Jet {
  Eigen::Vector3d position, axis;
  Drive drive{Drive::kForce};
  double largest{};     ///< N: more is not told
  double diameter{};    ///< m, of a propeller, or of the one before a fin
  double thrust_0{};    ///< K_T at rest
  double thrust_1{};    ///< slope of K_T over the advance ratio
  double area{};        ///< m^2, of a fin
  double slope{};       ///< 1/rad, of its lift
  double stall{};       ///< rad
  double aspect{};      ///< ratio, of its induced drag
  double reference{};   ///< m/s
  int behind{-1};       ///< jet in whose wash a fin stands
  double share{};       ///< of the wash that reaches it
  double torque{};      ///< m: moment about the axis over thrust
  double moved_mass{};  ///< kg
};

/// A fixed foil or a hull that lifts as one, at its centre of pressure.
struct Foil {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};
  bool upright{};  ///< lifts sideways; else up and down
  double area{}, slope{}, stall{}, aspect{};
};

/// A slice of hull across the flow: cross-flow drag goes with its own speed (Faltinsen 1990, ch. 6).
struct Strip {
  double x{}, length{};   ///< m
  double side{}, plan{};  ///< m, height and width
};

enum class CraftClass { kRov, kTorpedo, kBoat, kShip, kGlider };
constexpr std::array<const char*, 5> kClassNames{"rov", "torpedo", "boat", "ship", "glider"};

struct Craft {
  std::string family;
  Hull hull;
  double density{};          ///< kg/m^3
  double nominal_voltage{};  ///< V
  Eigen::Vector3d extent;    ///< m, length, width, height
  std::vector<Jet> jets;
  std::array<bool, 6> actuated{};
  std::array<bool, 6> moves{};  ///< degrees of freedom of the owner's file
  CraftClass craft_class{};
  bool surfaced{};  ///< heave, roll and pitch are held by the surface
  std::vector<Foil> foils;
  std::vector<Strip> strips;
  double cross_drag{};        ///< of the strips, coefficient
  double windage{};           ///< m^2, side view of what stands above the water
  Vector6 pace;               ///< m/s, rad/s: typical speed of a trial
  bool states_moments{true};  ///< the owner lets the first moment be identified; else it is zero (trimmed neutral)
  [[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> allocation() const;
};

enum class Family { kAft, kCross, kVectored, kTriangle, kHeavy, kSlender };
constexpr int kFamilies = 6;

/// kHeavy and kSlender move in six degrees of freedom, the others in surge, sway, heave and yaw.
[[nodiscard]] Craft draw_craft(Family family, Random& random);
/// A craft of another class.
[[nodiscard]] Craft draw_other_craft(CraftClass craft_class, Random& random);

}  // namespace fathom::sealed
