// The sensor check in words for a terminal: what agrees, what disagrees, what nobody can tell, with the numbers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/consistency/consistency.hpp"

namespace fathom::consistency {

/// Takes out what concerns velocities and rates outside `dof` (order u v w p q r): nobody asks for them.
void keep_axes(ConsistencyResult& result, const std::array<bool, 6>& dof);
/// One line per quantity: mismatch as measured, answer, and the fault that would have been seen.
[[nodiscard]] std::vector<std::string> table_of(const ConsistencyResult& result);
/// One sentence. "The sensors agree" only where every quantity that was compared would have shown a fault of practical
/// size.
[[nodiscard]] std::string conclusion_of(const ConsistencyResult& result);

}  // namespace fathom::consistency
