// What no vehicle has: for every quantity of a vehicle file the largest magnitude that physics or engineering has seen,
// and the smallest where zero makes no sense. They are wide, against slips of the unit or of the exponent; what one
// vehicle's numbers say about each other is Vehicle's to judge.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace fathom::model {

struct PhysicalBound {
  std::string_view key;   ///< "mass"; "*": every other quantity of this unit
  std::string_view unit;  ///< as Vehicle reads it
  double least{};         ///< of what is positive; whether zero makes sense is Vehicle's to say
  double most{};          ///< magnitude
  std::string_view reason;
};

[[nodiscard]] std::span<const PhysicalBound> physical_bounds();

/// "" when this value is possible; else what is wrong with it. std::logic_error for a unit that has no bound: a
/// quantity added to the vehicle file needs a row.
[[nodiscard]] std::string beyond_physics(const std::string& key, const std::string& unit, double value);

}  // namespace fathom::model
