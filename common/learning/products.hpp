// What a learned force may run over: every term times every modulator, each product a group of one to a few columns,
// scaled to the applied wrench (docs/decisions/189).
#pragma once

#include "common/inference/scan.hpp"

namespace fathom::learning {

/// Of a seen model. What its base numbers hold enters modulated only. `of_recording`: with tables over time and swings,
/// which tell of no other recording.
[[nodiscard]] likelihood::FreeForce products_of(const likelihood::Problem& problem, const inference::Seen& seen,
                                                const model::Scene& scene, bool of_recording);

}  // namespace fathom::learning
