// Leave-run-out validation: every recording is predicted once by what was found on others.
#pragma once

#include <string>
#include <vector>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// One division of the recordings.
struct Fold {
  std::vector<std::string> fitted, held_out;  ///< paths
};

/// `count` of them, or one per recording where there are fewer recordings; each recording is held out once, in the
/// order of names. InputError for fewer than two recordings.
[[nodiscard]] std::vector<Fold> folds_of(std::vector<std::string> paths, int count);

/// A line per fold: what was found, and the error of prediction 10 s ahead of the base model and with what was found;
/// below them all together, and how often each effect was found.
[[nodiscard]] std::string fold_table(const std::vector<DiagnosisResult>& results);

}  // namespace fathom::report
