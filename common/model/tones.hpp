// Oscillating forces in a run, at frequencies that nobody knows beforehand: where a search for waves may begin.
#pragma once

#include <vector>

#include "common/model/effect.hpp"

namespace fathom {
struct Trial;
}

namespace fathom::model {

struct Tones {
  std::vector<Tone> horizontal, vertical;  ///< most prominent first
};

/// What a linear regression of the run's accelerations on the base model leaves, turned into W, at the `most`
/// peaks of its spectrum each that stand out most from their neighbourhood. Empty without velocity or attitude, or in a
/// run too short.
[[nodiscard]] Tones strongest_tones(const Vehicle& vehicle, const Trial& trial, std::size_t most);

}  // namespace fathom::model
