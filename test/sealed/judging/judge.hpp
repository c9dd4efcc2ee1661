// Opens the truth of one set and compares it with what fathom diagnose found.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace fathom::sealed {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A statement with odds: was it right?
struct Claim {
  double probability{};
  bool right{};
};

struct Score {
  std::uint64_t seed{};
  std::string kind, size;          ///< size: the class nearest to the share that was reached; "faint" when below all
  std::vector<std::string> truth;  ///< names
  std::vector<std::string> found;  ///< accepted names, in the tool's order
  std::string verdict;
  /// single: named, alias, later, missed, wrong.  pair and mixed: whole, half, missed, wrong (mixed: also where a wrong
  /// name stands beside right ones).  many: whole, part, missed, wrong.  clean and noise: silent, false alarm.  foreign: refused, hesitant, wrong name.
  /// Any: failed.
  std::string outcome;
  bool good{};             ///< the outcome that is wished
  int strangers{};         ///< accepted names that are not in the truth nor an alias of it
  int of_nature{};         ///< accepted names of what the craft's own flow does, beside those of `found`
  bool in_sensor_check{};  ///< a fault of an instrument that the comparison of sensors reported by itself
  double before{kUnknown}, after{kUnknown}, floor{kUnknown}, base{kUnknown};  ///< normalised 5 s errors
  double before_far{kUnknown}, after_far{kUnknown};                           ///< the same at 10 s
  bool learned{false}, carried{false};  ///< a correction was adopted; it is part of the model on the new recording
  std::string correction;               ///< equation, groups or why it was refused
  double seconds{}, processor{}, megabytes{};  ///< processor: of both cores together, s
  std::vector<Claim> claims;
  /// (found - true) over what is 1.96 at the end of the stated 95 % interval, of effect parameters that mean the same.
  std::vector<double> deviations;
  bool wrong_form{};               ///< right name, but another thruster, axis or law than the true one
  bool tilts{false};               ///< roll or pitch is free
  std::vector<double> over_all;    ///< as over_bound, over the bound of all signals
  std::vector<double> over_bound;  ///< (found - true) / Cramer-Rao bound, of base numbers on clean data
};

/// `run` is what the runner measured; `result` is empty when the tool failed.
[[nodiscard]] Score judge(const nlohmann::json& truth, const nlohmann::json& result, const nlohmann::json& run);
[[nodiscard]] nlohmann::json to_json(const Score& score);

}  // namespace fathom::sealed
