// Which effects a data set lets one ask for, and of those that it does not, why: the effects themselves are asked what
// they could do if more had been measured, or if the vehicle file were another.
#pragma once

#include <string>
#include <vector>

#include "common/model/effect.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::preflight {

/// "not applicable: ..." for an effect without a form in this scene.
[[nodiscard]] std::string why_not_asked(const model::Effect& effect, const model::Scene& scene);

/// Groups of signals that were not measured, and the effects that cannot be asked for that reason.
[[nodiscard]] std::vector<NotMeasured> not_measured(const model::Scene& scene);

/// The same as sentences; empty when everything was measured that the vehicle's axes and the effects need.
[[nodiscard]] std::string not_measured_sentences(const std::vector<NotMeasured>& groups, const model::Vehicle& vehicle);

}  // namespace fathom::preflight
