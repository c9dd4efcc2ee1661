// Words and numbers as people read them: axis names, odds, percentages, HTML escaping, wrapping for the terminal.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// One degree of freedom as it is named everywhere in the report.
struct Axis {
  const char* name;        ///< "surge"
  const char* velocity;    ///< "u", key of result.json
  const char* unit;        ///< "m/s" or "deg/s": unit in pictures and tables
  double scale;            ///< SI to `unit`
  const char* force;       ///< "X", key of result.json
  const char* force_unit;  ///< "N" or "N m"
};

/// Order u v w p q r.
extern const std::array<Axis, 6> kAxes;

[[nodiscard]] std::string velocity_label(const Axis& axis);  ///< "surge u [m/s]"
[[nodiscard]] std::string force_label(const Axis& axis);     ///< "surge force X [N]"

/// `digits` significant digits, plain notation where that is short; "-" when not finite.
[[nodiscard]] std::string number(double value, int digits = 3);
/// "1 s ahead" from 1.0: no zeros that mean nothing.
[[nodiscard]] std::string plain(double value);
/// R2 with two decimals, at most five characters.
[[nodiscard]] std::string r_squared(double value);
/// 0.314 becomes "31 %".
[[nodiscard]] std::string percent(double share);
/// "95 %: 3 % to 9 %" of two shares, or that too few windows tell.
[[nodiscard]] std::string percent_interval(double low, double high);
/// Where a motion can be foretold for a while only, how long that is; else empty.
[[nodiscard]] std::string how_far(const Foretold& foretold);
/// "5 s ahead", or how far most motions can be foretold where that is less.
[[nodiscard]] std::string five_seconds_ahead(const Foretold& foretold);
/// "20 : 1" for ln 20; powers of ten beyond a million.
[[nodiscard]] std::string odds(double log_odds);
/// Three digits; what differs from even odds by less than a hundredth is 0.
[[nodiscard]] std::string log_odds_text(double log_odds);
/// "thruster_lag", "thruster 3" become "thruster lag (thruster 3)".
[[nodiscard]] std::string effect_title(const std::string& name, const std::string& variant = "");
/// "97 % of the applied force, 3.1 times what is left there": the latter where it is known (0: not).
[[nodiscard]] std::string size_beside_rest(double share, double over);
/// "value ± half width of the 95 % interval unit", or "value (low to high) unit" where the sides differ.
[[nodiscard]] std::string with_interval(const NamedValue& value);
[[nodiscard]] std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// Safe inside HTML text and quoted attributes; control characters are dropped.
[[nodiscard]] std::string escape(std::string_view text);

/// Columns that UTF-8 text takes in a terminal (no wide characters expected).
[[nodiscard]] std::size_t columns(std::string_view text);
/// Filled with spaces on the right (left) to `width` columns, or cut with an ellipsis.
[[nodiscard]] std::string pad_right(std::string_view text, std::size_t width);
[[nodiscard]] std::string pad_left(std::string_view text, std::size_t width);
/// Lines of at most `width` columns, broken at spaces and, where a word is too long, inside it.
[[nodiscard]] std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// Findings of several runs that say the same about the same pair of signals.
struct FindingGroup {
  std::vector<const ConsistencyFinding*> members;  ///< first: the largest
  double smallest{};
  double largest{};
};

/// Grouped by signal, reference, finding, unit and action, in order of first appearance. Points into `findings`.
[[nodiscard]] std::vector<FindingGroup> group_findings(const std::vector<ConsistencyFinding>& findings);
/// "0.08 s" or, over several runs, "0.06 to 0.11 s".
[[nodiscard]] std::string size_text(const FindingGroup& group);

/// True for an axis that was simulated: some prediction error of it is finite.
[[nodiscard]] bool predicted(const DiagnosisResult& result, std::size_t axis);
/// The candidate's accepted form, or nullptr.
[[nodiscard]] const EffectFound* accepted_form(const DiagnosisResult& result, const CandidateTried& candidate);

}  // namespace fathom::report
