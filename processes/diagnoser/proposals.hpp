// What to fly when the diagnoser cannot tell two candidates apart. Flying segments in advance takes seconds, so that it
// is done beside the trial; the answer belongs to the ranking that follows, whenever it came.
#pragma once

#include <future>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/model/effect.hpp"
#include "common/planning/live_separation.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::diagnoser {

using Rivals = std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>>;

class Proposals {
 public:
  explicit Proposals(planning::LiveSeparation separation) : separation_{std::move(separation)} {}

  void hear(const ModelEstimate& model) { model_ = model; }
  /// Names the segment in `ranking` once it is known for these rivals.
  void complete(EffectRanking& ranking, const Rivals& rivals);
  void reset();

 private:
  planning::LiveSeparation separation_;
  std::optional<ModelEstimate> model_;
  std::map<std::string, std::optional<planning::Answer>> answers_;
  std::string asked_;
  std::future<std::optional<planning::Answer>> answer_;
};

}  // namespace fathom::diagnoser
