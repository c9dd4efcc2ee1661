// Writes what `fathom diagnose` leaves behind: result.json for programs, report.html for people.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/result_origin.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::report {

struct Written {
  std::string json;  ///< path of result.json
  std::string html;  ///< path of report.html
};

/// Makes `folder` where needed and writes both files; result.json first, so that it stands even when gnuplot is
/// missing. InputError when a file cannot be written or the pictures cannot be drawn.
Written write(const DiagnosisReport& report, const std::string& folder, const VerdictGiven& given = {},
              const ResultOrigin& origin = {});

}  // namespace fathom::report
