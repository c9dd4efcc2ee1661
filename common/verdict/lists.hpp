// What result.json lists: numbers, named effects and stand-ins, candidates with why they were refused or not asked.
#pragma once

#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/inference/infer.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

constexpr double kNotAsked = std::numeric_limits<double>::quiet_NaN();  ///< null in result.json

/// A name claims a cause only where nothing that no list holds stands beside it: with such a thing in the data every
/// listed law that resembles a part of it has enormous odds, and none means anything (docs/decisions/194).
[[nodiscard]] bool names_claim(inference::Verdict verdict);

/// The fit's numbers but a learned force's weights, SI. `sigma`: of the numbers. `withheld`: axes of which none is
/// told.
[[nodiscard]] std::vector<NamedValue> numbers_of(const likelihood::Fit& fit, const Eigen::VectorXd& sigma,
                                                 const std::set<int>& withheld);

/// Places of the found effects, the surest first: the order in which people are told of causes.
[[nodiscard]] std::vector<std::size_t> surest_first(const inference::Found& found);

/// Effects of `fit`, which gives all other numbers too; causes the surest first, stand-ins, whose odds mean nothing, as
/// they act. `in_model`: of stand-ins.
void list_effects(const inference::Conclusion& conclusion, const likelihood::Fit& fit, const Eigen::VectorXd& sigma,
                  bool in_model, DiagnosisResult& result);

/// Effects that were asked for and not taken, each with its rules.
void list_refused(const inference::Found& found, DiagnosisResult& result, VerdictGiven& given);

/// Effects that have no form in these runs, with the reason.
void list_not_asked(const model::Scene& scene, DiagnosisResult& result);

/// The first named effect that another may stand in the place of, and that other as it was fitted there.
[[nodiscard]] std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>> rivals_in(
    const inference::Conclusion& conclusion, const likelihood::Fit& named);

}  // namespace fathom::verdict
