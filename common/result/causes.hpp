// What decided the verdict of a diagnosis by trajectories, as data: every cause with its value and its threshold.
#pragma once

#include <vector>

#include "common/identification/fit_result.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::result {

/// The causes, those that decide first. NaN where a cause has no value or no threshold. What they are is listed in
/// cause_words.hpp.
[[nodiscard]] std::vector<CauseGiven> causes_of(const DiagnosisResult& result);

/// Names and covariance of a fit's free parameters, in physical units; those that a vehicle's file holds fixed, and
/// numbers of an effect that its form does not use, are left out. Nothing where the fit has none.
void put_covariance(const identification::FitResult& fit, VerdictGiven& given);

}  // namespace fathom::result
