// Standard sets of the equations of motion: whose coefficients are published under which names, what they multiply, and
// what stands beside them. A vehicle file names one (`hydrodynamics: {model: NAME}`). Each is a file and a line of
// standard_sets.def.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "common/model/manoeuvring/manoeuvring_terms.hpp"

namespace fathom::model {

struct Motion;
struct Vehicle;

/// Where a set has the Coriolis and centripetal terms of added mass.
enum class AddedCoriolis {
  kAmongTerms,  ///< in its coefficients
  kForces,      ///< those of forces stand in its equations of motion, the Munk moment is in its coefficients
  kWhole        ///< all of them stand in its equations of motion
};

struct StandardSet {
  std::string_view name;
  std::string_view source;
  std::span<const ManoeuvringTerm> terms;
  std::array<bool, 6> moves{};  ///< motions that it describes, u to r; the others do not change
  AddedCoriolis coriolis{};
  bool is_base{false};  ///< the base model has all of it
  bool needs_draught{false};
  bool needs_cruise{false};  ///< it is an expansion about a speed ahead
  /// Wrench [N, N m] of the actuators as the set has it, given their forces in motion.force.
  Vector6d (*pushed)(const Vehicle&, const Motion&){};

  /// Nothing when no term has this name.
  [[nodiscard]] const ManoeuvringTerm* find(std::string_view term) const;
};

/// All of them, in the order of standard_sets.def.
[[nodiscard]] std::span<const StandardSet* const> standard_sets();
/// Nothing when none has this name.
[[nodiscard]] const StandardSet* find_standard_set(std::string_view name);
/// "gertler_submarine, remus, ..."
[[nodiscard]] std::string standard_set_names();

/// The set of who states none.
[[nodiscard]] const StandardSet& gertler_submarine();

/// Velocities past the water and the angles of rudders and planes: means of those that push sideways, and up and down.
[[nodiscard]] TermMotion term_motion(const Vehicle& vehicle, const Motion& motion);

/// What the water does to the hull by the vehicle's set [N, N m]: by its coefficients, and what of added mass' Coriolis
/// terms is not among them. The vehicle has hydrodynamics.
[[nodiscard]] Vector6d by_coefficients(const Vehicle& vehicle, const Motion& motion);
[[nodiscard]] Vector6d added_coriolis(const Vehicle& vehicle, const Motion& motion);
/// Both.
[[nodiscard]] Vector6d hull_wrench(const Vehicle& vehicle, const Motion& motion);

/// What the set has beside a base model of the same masses and actuators [N, N m]: its wrench without drag along each
/// axis by that axis' own velocity, which the base model has, and without what both have of Coriolis terms; how it
/// differs in what actuators do. A series about a speed ahead keeps what it has along that axis, its propeller with it.
[[nodiscard]] Vector6d beside_base(const Vehicle& vehicle, const Motion& motion);

/// acting_wrench() without the rudders and planes whose angles are among the coefficients.
[[nodiscard]] Vector6d pushed_but_for_steering(const Vehicle& vehicle, const Motion& motion);

}  // namespace fathom::model
