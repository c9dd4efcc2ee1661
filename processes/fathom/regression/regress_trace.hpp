// Whence a regression's residual comes, as a table for a terminal and as a section of the page.
#pragma once

#include <span>
#include <string>

#include "common/identification/regression/residual_tracing.hpp"
#include "common/report/page_parts.hpp"

namespace fathom::tool {

void print_trace(std::span<const identification::TracedPull> traced);

/// Of each force that a load cell measured: what it would leave, and over time what it leaves and is. Nothing where
/// none was measured.
[[nodiscard]] std::string trace_section(std::span<const identification::TracedPull> traced, report::Album& album);

}  // namespace fathom::tool
