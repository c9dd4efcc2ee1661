// The force that is added to a model: products of terms and modulators, screened beside the fitted model, fitted with
// the noise anew, and what the first fit leaves screened again. It is sought once the listed effects have been, and
// explains what they leave; what it could do in a name's place is the search's question (docs/decisions/172), which
// asks broad groups for it. Long recordings are screened on stretches of them; what is found is fitted to all of them.
#pragma once

#include "common/base/progress.hpp"
#include "common/inference/free_force.hpp"
#include "common/inference/stretches.hpp"
#include "common/learning/limits.hpp"

namespace fathom::learning {

struct Sought {
  inference::FreeForceFound all;
  inference::FreeForceFound lasting;  ///< before tables over the recording's time were asked for what it leaves
};

/// Beside `base`; groups in the order of what each is worth beside the others. No fit: nothing is worth its price.
/// `stretches` of the recordings, where they are long: screened instead of all of them.
[[nodiscard]] Sought seek_force(const likelihood::Problem& problem, const likelihood::Fit& base,
                                const model::Scene& scene, const Limits& limits, int threads, const Progress& progress,
                                const std::optional<inference::Stretches>& stretches = std::nullopt);

}  // namespace fathom::learning
