// A force that no list holds becomes part of the model, or is refused with the reason: evidence, practical size, and a
// lower open-loop error on stretches of the recording that its weights were not fitted to (docs/decisions/170).
#pragma once

#include <memory>

#include "common/base/progress.hpp"
#include "common/inference/infer.hpp"
#include "common/learning/limits.hpp"
#include "common/model/learned/learned_force.hpp"
#include "common/samples/correction.hpp"

namespace fathom::learning {

struct Settings {
  bool learn{true};
  Limits limits{};
  Leaving leaving{};
};

struct Learned {
  CorrectionGiven given;
  likelihood::Fit fit;  ///< numbers with the force, by the multi-horizon score where that errs less; adopted only
  std::shared_ptr<const model::LearnedForce> here;       ///< on the recordings that it was learned from
  std::shared_ptr<const model::LearnedForce> elsewhere;  ///< on others; empty: nothing is carried there
  std::shared_ptr<const model::LearnedForce> later;      ///< on those whose clock goes on after these; empty likewise
  double until{};                                        ///< s: the end of the recordings on that clock
};

/// `of`: the trials of `problem`. `judged_here`: on stretches of them, so that what holds there alone helps.
[[nodiscard]] Learned learn(const likelihood::Problem& problem, std::span<const Trial> of,
                            const inference::Conclusion& conclusion, const Settings& settings, bool judged_here,
                            int threads, const Progress& progress);

/// likelihood::model_of(), with `force` where there is one, which must outlive it.
[[nodiscard]] model::Model as_model(const likelihood::Hypothesis& hypothesis, double input_step,
                                    const model::LearnedForce* force = nullptr);

/// What a recording has shown of what features read.
[[nodiscard]] model::Visited visited_by(const likelihood::Problem& problem, const likelihood::Hypothesis& hypothesis);

}  // namespace fathom::learning
