// A measured column as a candidate input of a force, as an engineer writes it: a product of columns, of the model's own
// motion and thrust, and of powers, along a measured bearing where one is given:
//
//   wind_speed^2    voltage*tau_X    |tension|*u    "winch length"    wind_speed*wind_speed @ wind_direction
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fathom::model {

struct Candidate {
  /// name^power, or |name|^power.
  struct Power {
    std::string name;
    bool size{};  ///< without its sign
    int power{1};
  };
  std::string text;            ///< as it is told
  std::vector<Power> columns;  ///< measured; one at least
  std::vector<Power> model;    ///< u v w p q r, U (speed past the water of the first three), tau_X ... tau_N
  std::string bearing;         ///< column, rad clockwise from north, along which it acts; empty: any axis
};

/// InputError that says what is wrong, and where.
[[nodiscard]] Candidate parse_candidate(std::string_view text);
/// The same, added; InputError where it stands there already.
void add_candidate(std::string_view text, std::vector<Candidate>& candidates);

/// What results call its effect: "column wind_speed^2".
[[nodiscard]] std::string effect_name(const Candidate& candidate);

/// A unit to that power: "V^2", "(m/s)^2"; nothing of nothing.
[[nodiscard]] std::string power_of_unit(const std::string& unit, int power);
/// Both multiplied: "V m/s".
[[nodiscard]] std::string times_unit(const std::string& one, const std::string& other);

}  // namespace fathom::model
