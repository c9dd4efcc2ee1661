// Units as text: "N/(m/s)^2", "deg", "mbar". Turns a number with a unit into SI and refuses the wrong dimension.
#pragma once

#include <numbers>
#include <string_view>

namespace fathom {

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< rad

/// Factor that takes a value in `from` to a value in `to`; InputError when unknown or of another dimension.
/// "deg" to "rad" is pi/180; "us" to "s" is 1e-6.
[[nodiscard]] double unit_factor(std::string_view from, std::string_view to);

}  // namespace fathom
