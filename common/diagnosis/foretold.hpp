// How much of the motion the final model foretells, in words: what it cannot foretell is doubt in every name.
#pragma once

#include <string>
#include <vector>

#include "common/model/effect.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

struct Foretold {
  std::string axis;
  double share{};  // R2, 5 s ahead
  bool blind{};    // to assume the average would be better
};

/// Axes of which the final model certainly foretells less than half of the motion although what is left there is not
/// random.
[[nodiscard]] std::vector<Foretold> badly_foretold(const DiagnosisResult& result);
/// True when there is no axis of which the final model foretells anything, 5 s ahead, and none of whose motion in the
/// runs that it was fitted to it explains half: `left`, residual scale per axis there, m/s and rad/s. A validation run
/// at rest alone speaks against no name.
[[nodiscard]] bool foretells_nothing(const DiagnosisResult& result, const model::Scene& fitted, const Vector6d& left);
/// Where thrust is followed so badly that the file itself is in doubt: axes that are badly foretold, or where more is
/// left than was applied.
[[nodiscard]] std::vector<std::string> not_followed(const DiagnosisResult& result,
                                                    const std::vector<Foretold>& foretold);

[[nodiscard]] std::string foretold_sentence(const std::vector<Foretold>& axes);
/// Axes of which the model foretells little on too little motion for that to mean anything.
[[nodiscard]] std::string hardly_shown_sentence(const DiagnosisResult& result);

}  // namespace fathom::diagnosis
