// What to drive next, in words; a site's segments are worked out elsewhere (planning).
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::verdict {

/// After thrusters that seem to be others: each alone. Else the motions that tell look-alikes apart, then what
/// separates the arguments of what acts without a name, else the one that sharpens the number of a named effect that is
/// known worst, where that is known badly. Empty where nothing is open.
[[nodiscard]] std::string next_motion(const DiagnosisResult& result);

}  // namespace fathom::verdict
