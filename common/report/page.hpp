// The report page: one HTML file that opens without a network, pictures first.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// The whole page. InputError when gnuplot cannot draw.
[[nodiscard]] std::string to_html(const DiagnosisReport& report, const std::string& gnuplot = "gnuplot");

}  // namespace fathom::report
