// A closed form in place of a learned force, where one fits. A form is told where its evidence is not far below the
// learned force's.
#pragma once

#include <optional>

#include "common/base/progress.hpp"
#include "common/learning/grammar.hpp"
#include "common/samples/correction.hpp"

namespace fathom::learning {

struct FormulaFound {
  Form form;
  double inner{}, inner_sigma{};
  std::vector<double> amplitude, amplitude_sigma;  ///< SI, per product of the features
  double over_learned{};                           ///< nats over the learned force, prices of both paid
  double over_base{};                              ///< nats over the model without either, its price paid
  likelihood::Fit fit;
};

/// The best form, fitted in full; nothing where none could be. `base`: fit of the model with the listed effects alone.
[[nodiscard]] std::optional<FormulaFound> find_formula(const likelihood::Problem& problem, const likelihood::Fit& base,
                                                       const model::Scene& scene,
                                                       const inference::FreeForceFound& found, int threads,
                                                       const Progress& progress);

/// The learned force itself, where all of it can be written as a law of a few amplitudes.
[[nodiscard]] std::optional<FormulaFound> as_formula(const inference::FreeForceFound& found);

/// As result.json holds it.
[[nodiscard]] FormulaGiven given_of(const FormulaFound& found);

}  // namespace fathom::learning
