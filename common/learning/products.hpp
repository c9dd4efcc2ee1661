// What a learned force may run over: every term times every modulator, each product a group of one to a few columns,
// scaled to the applied wrench (docs/decisions/189).
#pragma once

#include "common/inference/scan.hpp"

namespace fathom::learning {

/// How much of the clock a library may read: laws that last; swings, too, which go on while the clock does; tables over
/// time, too, which tell of no other recording.
enum class Clock : std::uint8_t { kLasting, kSwings, kTables };

/// Of a seen model. What its base numbers hold enters modulated only.
[[nodiscard]] likelihood::FreeForce products_of(const likelihood::Problem& problem, const inference::Seen& seen,
                                                const model::Scene& scene, Clock clock);

}  // namespace fathom::learning
