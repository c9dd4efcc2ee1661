// What is said of a learned force: a correction with arguments, never a cause.
#pragma once

#include <string>

#include "common/inference/free_force.hpp"
#include "common/samples/correction.hpp"

namespace fathom::learning {

[[nodiscard]] std::string correction_sentence(const inference::FreeForceFound& found, const CorrectionGiven& given);
/// What may lie behind its strongest group; empty: nothing is known of such groups.
[[nodiscard]] std::string look_for(const inference::FreeForceFound& found);
/// "log odds 8.1, at least 20 needed"
[[nodiscard]] std::string too_little(const std::string& what, double value, const std::string& how, double needed);

/// By how much its numbers spread predictions, and what was not visited; begins with a blank. Empty: nothing is known.
[[nodiscard]] std::string spread_sentence(const CorrectionGiven& given);

}  // namespace fathom::learning
