// The answer of `fathom diagnose` as result.json, for other programs.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::report {

/// `given`: causes and refusals of the likelihood's core, where it answered.
/// JSON text, schema 1, SI units and radians; numbers that do not exist are null.
[[nodiscard]] std::string to_json(const DiagnosisResult& result, const VerdictGiven& given = {});

}  // namespace fathom::report
