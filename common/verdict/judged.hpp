// Runs that judge: which part of a learned force may be told of them, and what models foretell of them.
#pragma once

#include <span>
#include <vector>

#include "common/inference/infer.hpp"
#include "common/learning/learn.hpp"
#include "common/residual/open_loop.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

/// The runs that judge, in steps of 40 ms, beside those that were fitted. Refers to its arguments.
struct Judges {
  Judges(const model::Vehicle& craft, std::span<const Trial> train, std::span<const Trial> validate);

  /// Predictions by both models, each as far as a motion can be foretold; begun when `after` remembers what it should.
  [[nodiscard]] residual::Foreseen windows(const model::Model& before, const model::Model& after) const;

  const model::Vehicle& vehicle;
  std::span<const Trial> fitted;
  std::span<const Trial> recorded;  ///< as they were given
  std::vector<Trial> unseen;
  double input_step{};  ///< s, of thrust in these runs
  bool here{};          ///< all that judges are stretches of the runs that were fitted
};

/// The learned force for runs that judge: whole on stretches of the runs that it was learned from, else what lasts.
[[nodiscard]] const model::LearnedForce* force_for(const learning::Learned& learned, const Judges& judges);

/// Surely, or where too few windows tell how sure that is, by much.
[[nodiscard]] bool helps(const Interval& gain);

/// By how much the open-loop error on the runs that judge falls from `before` to `after`; NaN where these have no
/// window.
[[nodiscard]] Interval gain_of(const Judges& judges, const model::Model& before, const model::Model& after);
/// The same with the names.
[[nodiscard]] Interval held_back(const Judges& judges, const inference::Conclusion& conclusion);

/// Predictions beside the simplest ones. An axis that is foretold worse than by saying that nothing changes has no
/// model.
void judge_predictions(const Judges& judges, const model::Model& before, const model::Model& after,
                       DiagnosisReport& report, VerdictGiven& given, inference::Conclusion& conclusion);

/// What the learned force leaves open.
void tell_of_spread(const Judges& judges, const likelihood::Problem& problem, const learning::Learned& learned,
                    const model::LearnedForce& force, CorrectionGiven& given);

}  // namespace fathom::verdict
