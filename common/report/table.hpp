// The verdict for the terminal: plain text, UTF-8, at most 100 columns.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

constexpr std::size_t kTableColumns = 100;

/// Verdict, errors before and after, effects accepted and refused, sensors that disagree.
[[nodiscard]] std::string to_table(const DiagnosisResult& result);

}  // namespace fathom::report
