// Whether a name's own law holds: what it would gain if its strength went with something else besides.
#pragma once

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// How the strength of a name's force changes where it may go with depth, place, heading, speed, its own size or time:
/// with that of them, among those that are worth anything, with which it changes most.
struct Modulation {
  double nats{};   ///< after its price; 0: none is worth anything
  double depth{};  ///< rms of the change of its strength, as a share of it
};

/// Of an effect of the seen model. A law that is right stays as it is wherever the craft goes; one that resembles a
/// part of something else is strong here and weak there. Effects on sensors are not asked.
[[nodiscard]] Modulation modulation_of(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                                       std::size_t effect, const Thresholds& thresholds);

}  // namespace fathom::inference
