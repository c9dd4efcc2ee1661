// The answer of the likelihood's core in the form of `fathom diagnose`: numbers from common/inference, predictions on
// runs that no fit has seen, and all sentences.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/inference/infer.hpp"
#include "common/learning/learn.hpp"
#include "common/model/candidates/column_effect.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

/// In place of an axis: a model's lack that a learned force has taken the place of.
inline constexpr std::string_view kLearned = "what was learned";

struct Answer {
  DiagnosisReport report;
  VerdictGiven given;
  inference::Verdict verdict{inference::Verdict::not_judged};
  double score{};              ///< nats: evidence of the best set of names, its prior included
  double velocities{};         ///< scored measurements of surge, sway and heave, each a mean over a block
  likelihood::Fit best;        ///< the model after, with the named effects
  Eigen::VectorXd best_sigma;  ///< of its numbers; empty where nothing was fitted
  /// Effects of measured columns, which models here point to.
  model::Candidates candidates;
  /// A named effect, and the likeliest other in its place where that one cannot be ruled out.
  std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>> rivals;
};

/// Diagnosis of `train`, predictions on `validate`. Consistency findings are the caller's to add.
[[nodiscard]] Answer diagnose(const model::Vehicle& vehicle, std::span<const Trial> train,
                              std::span<const Trial> validate, const inference::Settings& settings,
                              const Progress& progress, const learning::Settings& learning = {});

/// Why a candidate was not taken: "log odds 3.2, 10 needed".
[[nodiscard]] std::string sentence(const inference::Refusal& refusal);

/// The verdict in plain words.
[[nodiscard]] std::string paragraph(const inference::Conclusion& conclusion);

/// What of that swings, in a sentence and a space before it, or nothing.
[[nodiscard]] std::string what_swings(std::span<const AxisWhiteness> left);

}  // namespace fathom::verdict
