// What to fly when the diagnoser cannot tell two candidates apart: asked once for each pair, a tenth of a second.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/live/background_search.hpp"
#include "common/planning/live_separation.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::diagnoser {

class Proposals {
 public:
  explicit Proposals(planning::LiveSeparation separation) : separation_{std::move(separation)} {}

  void hear(const ModelEstimate& model) { model_ = model; }
  /// Names the segment that tells the rivals apart, if there is one.
  void complete(EffectRanking& ranking, const live::Rivals& rivals);
  void reset();

 private:
  planning::LiveSeparation separation_;
  std::optional<ModelEstimate> model_;
  std::map<std::string, std::optional<planning::Answer>> answers_;
};

}  // namespace fathom::diagnoser
