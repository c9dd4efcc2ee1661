// While a trial runs: which segment would tell two candidates apart that its data cannot? It is flown in advance by the
// model as the identifier knows it.
#pragma once

#include <optional>

#include "common/planning/energies.hpp"
#include "common/planning/rehearsal.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::planning {

class LiveSeparation {
 public:
  LiveSeparation(const model::Vehicle& vehicle, const RehearsalSettings& settings);

  /// At the sizes at which both explain the trial so far. A whole segment at least: evidence on line comes in blocks.
  /// Empty when no segment would tell them apart.
  [[nodiscard]] std::optional<Answer> between(const model::ActiveEffect& first, const model::ActiveEffect& second,
                                              const ModelEstimate& known) const;

 private:
  model::Vehicle vehicle_;
  RehearsalSettings settings_;
};

}  // namespace fathom::planning
