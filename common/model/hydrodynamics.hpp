// What a vehicle file may say of a vehicle that is flown and identified by hydrodynamic derivatives: the standard set
// that they belong to, length, added mass, coefficients, a reference set, umbilical, chain and load cells.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom {
class Config;
}

namespace fathom::model {

/// A cable that trails: half the drag of its swept length, at its attachment. Its own weight and inertia are not
/// modelled, nor the seabed's touch.
struct Umbilical {
  Eigen::Vector3d p_BU{Eigen::Vector3d::Zero()};  ///< m
  double diameter{};                              ///< m
  double paid_out{};                              ///< m
  double drag_coefficient{};                      ///< of a cylinder broadside
};

/// A chain that hangs to the seabed and drags on it: what is lifted weighs, what lies rubs. Height is held by it.
struct Chain {
  Eigen::Vector3d p_BC{Eigen::Vector3d::Zero()};  ///< m
  double weight{};                                ///< N/m in water
  double length{};                                ///< m
  double friction{};                              ///< of what lies, over its weight
  double seabed{};                                ///< m, depth
};

struct LoadCell {
  std::string name;
  std::string of;                                    ///< "thrusters", "umbilical" or "chain"
  Eigen::Vector3d p_BL{Eigen::Vector3d::Zero()};     ///< m
  Eigen::Vector3d axis_B{Eigen::Vector3d::UnitX()};  ///< unit: direction in which a positive load pushes the hull
};

/// How hull, propeller and rudder act on each other, by the symbols of the MMG method (mmg_3.cpp), dimensionless.
struct Interaction {
  double t_P{};                         ///< thrust deduction
  double w_P{};                         ///< wake fraction straight ahead
  double C_1{};                         ///< how fast the wake changes with the angle of the flow at the propeller
  std::array<double, 2> C_2{1.0, 1.0};  ///< to what, of a flow from starboard and from port (beta_P < 0, > 0)
  double x_P{};                         ///< the propeller's place, over the length
  double K_TJJ{};                       ///< of the propeller's open-water curve: K_T0 + K_TJ J + K_TJJ J^2
  double t_R{};                         ///< steering's resistance deduction
  double a_H{};                         ///< share of the rudder's force that the hull adds
  double x_H{};                         ///< where it adds it, over the length
  std::array<double, 2> gamma_R{};      ///< flow straightening, of beta_R < 0 and > 0
  double l_R{};                         ///< lever by which turning changes the flow at the rudder, over the length
  double epsilon{1.0}, kappa{}, eta{};  ///< wake at the rudder, the race's share, the height that it covers
};

struct Hydrodynamics {
  double length{};                                    ///< m, of the dimensionless numbers
  Matrix6d added_mass{Matrix6d::Zero()};              ///< kg, kg m, kg m^2: -X_udot, -X_vdot ... -N_rdot, row by row
  Eigen::Vector3d p_BB{Eigen::Vector3d::Zero()};      ///< m, centre of buoyancy
  Eigen::Vector3d p_BG{Eigen::Vector3d::Zero()};      ///< m, centre of mass
  Eigen::Vector3d products{Eigen::Vector3d::Zero()};  ///< kg m^2: I_xy, I_xz, I_yz of the inertia's matrix about it
  std::vector<ManoeuvringCoefficient> coefficients;
  std::vector<ManoeuvringCoefficient> reference;  ///< another set, to be printed beside (a planar motion mechanism's)
  std::optional<Umbilical> umbilical;
  std::optional<Chain> chain;
  std::vector<LoadCell> load_cells;  ///< order of LOADS
  const StandardSet* set{&gertler_submarine()};
  bool named{false};                       ///< the file names its set: these numbers are published of such a craft
  double draught{};                        ///< m; 0: not stated
  double cruise{};                         ///< m/s ahead about which the set is expanded; 0: not stated
  bool rigid_coriolis{true};               ///< false: the rigid body's Coriolis terms are among the coefficients
  std::optional<Interaction> interaction;  ///< of ships by the MMG method

  [[nodiscard]] TermLengths lengths(double density) const { return {length, draught, density}; }

  /// `inertia` [kg m^2]: of the vehicle file, about the centre of mass; products must go with it.
  /// The inertia's matrix about the centre of mass, of which the vehicle file states the `diagonal` [kg m^2].
  [[nodiscard]] Eigen::Matrix3d inertia(const Eigen::Vector3d& diagonal) const;

  [[nodiscard]] static Hydrodynamics from(const Config& config, const Eigen::Vector3d& inertia);
};

/// A map of the set's term names to numbers, or to {value, error}.
[[nodiscard]] std::vector<ManoeuvringCoefficient> read_coefficients(const Config& config, const StandardSet& set);

}  // namespace fathom::model
