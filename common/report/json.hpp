// The answer of `fathom diagnose` as result.json, for other programs.
#pragma once

#include <string>
#include <vector>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/result_origin.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::report {

/// `given`: causes, covariance, and the refusals of the likelihood's core where it answered.
/// JSON text as docs/schema/diagnosis-2.schema.json describes it: SI units and radians; numbers that do not exist are
/// null.
[[nodiscard]] std::string to_json(const DiagnosisResult& result, const VerdictGiven& given = {},
                                  const ResultOrigin& origin = {});

/// What `fathom check` found, as docs/schema/check-1.schema.json describes it.
struct CheckGiven {
  std::string vehicle;
  std::vector<std::string> runs;
  std::vector<std::string> compared;  ///< a line per quantity
  std::string conclusion;             ///< empty where there are findings
  std::vector<std::string> notes;
  std::vector<ConsistencyFinding> findings;
};
[[nodiscard]] std::string check_json(const CheckGiven& check);

}  // namespace fathom::report
