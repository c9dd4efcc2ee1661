// The answer of the likelihood's core in the form of `fathom diagnose`: numbers from common/inference, predictions on
// runs that no fit has seen, and all sentences.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/inference/infer.hpp"
#include "common/learning/learn.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

struct Answer {
  DiagnosisReport report;
  VerdictGiven given;
};

/// Diagnosis of `train`, predictions on `validate`. Consistency findings are the caller's to add.
[[nodiscard]] Answer diagnose(const model::Vehicle& vehicle, std::span<const Trial> train,
                              std::span<const Trial> validate, const inference::Settings& settings,
                              const Progress& progress, const learning::Settings& learning = {});

/// The verdict in plain words.
[[nodiscard]] std::string paragraph(const inference::Conclusion& conclusion);

}  // namespace fathom::verdict
