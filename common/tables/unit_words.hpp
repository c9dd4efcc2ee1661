// Units as people write them, in brackets behind a name ("r (°/s)") or at its end ("yaw_rate_dps").
#pragma once

#include <string>
#include <string_view>

namespace fathom::tables {

/// A unit in the words of unit_factor ("deg/s" for "dps"); empty where the text is none.
[[nodiscard]] std::string known_unit(std::string_view text);

struct NameWithUnit {
  std::string name;  ///< without the unit at its end
  std::string unit;  ///< empty: the name ends with none
};

/// "surge_cm_s", "Heading Deg", "rpm_port": a name whose last words are a unit; a name that is a unit ("rpm") is both.
[[nodiscard]] NameWithUnit unit_at_end(std::string_view name);

}  // namespace fathom::tables
