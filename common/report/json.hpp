// The answer of `fathom diagnose` as result.json, for other programs.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// JSON text, schema 1, SI units and radians; numbers that do not exist are null.
[[nodiscard]] std::string to_json(const DiagnosisResult& result);

}  // namespace fathom::report
