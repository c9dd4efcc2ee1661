// Why a model does not follow its thrust, measured beside the fit: thrusters that are exchanged, inputs that do not
// act, thrust in another unit.
#pragma once

#include <span>

#include "common/inference/infer.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::verdict {

/// Thrusters that are others than the file says leave much that no list explains: the file is asked first.
void seek_wiring(const model::Vehicle& vehicle, std::span<const Trial> train, DiagnosisResult& result,
                 inference::Conclusion& conclusion);

/// The likeliest reason beside the wiring for a model that does not follow its thrust, measured.
void seek_reason(const model::Vehicle& vehicle, std::span<const Trial> train, const inference::Thresholds& thresholds,
                 inference::Conclusion& conclusion);

}  // namespace fathom::verdict
