// The answer of `fathom diagnose` as result.json, for other programs.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/result_origin.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::report {

/// `given`: causes, covariance, and the refusals of the likelihood's core where it answered.
/// JSON text as docs/schema/diagnosis-1.schema.json describes it: SI units and radians; numbers that do not exist are
/// null.
[[nodiscard]] std::string to_json(const DiagnosisResult& result, const VerdictGiven& given = {},
                                  const ResultOrigin& origin = {});

}  // namespace fathom::report
