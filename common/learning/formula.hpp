// A closed form in place of a learned force, where one fits: laws along an axis, products of a base term and a
// modulator, with an inner number (an exponent, a moment, a frequency) that is fitted. A form is told where its
// evidence is not far below the learned force's.
#pragma once

#include <functional>
#include <optional>

#include "common/inference/free_force.hpp"
#include "common/samples/correction.hpp"

namespace fathom::learning {

/// A law: amplitudes times features that its inner number shapes.
struct Form {
  std::string words;         ///< what the force goes with: "the power n of the speed along u"
  std::string equation;      ///< of its amplitudes c, c_1, c_2 and the inner number, Fossen's notation
  std::string symbol, unit;  ///< of the inner number; no symbol: it has none
  int axis{};                ///< Feature::axis
  std::vector<double> grid;  ///< of the inner number; one value where it has none
  double price{};            ///< nats for having sought it
  std::function<std::vector<model::Feature>(double inner)> features;
};

struct FormulaFound {
  Form form;
  double inner{}, inner_sigma{};
  std::vector<double> amplitude, amplitude_sigma;  ///< SI, per product of the features
  double over_learned{};                           ///< nats over the learned force, prices of both paid
  double over_base{};                              ///< nats over the model without either, its price paid
  likelihood::Fit fit;
};

/// Forms along the axes of the learned force's groups, and along the world's.
[[nodiscard]] std::vector<Form> grammar(const likelihood::Problem& problem, const model::Scene& scene,
                                        const inference::FreeForceFound& found);

/// The best form, fitted in full; nothing where none could be. `base`: fit of the model with the listed effects alone.
[[nodiscard]] std::optional<FormulaFound> find_formula(const likelihood::Problem& problem, const likelihood::Fit& base,
                                                       const model::Scene& scene,
                                                       const inference::FreeForceFound& found, int threads);

/// The learned force itself, where all of it can be written as a law of a few amplitudes.
[[nodiscard]] std::optional<FormulaFound> as_formula(const inference::FreeForceFound& found);

/// As result.json holds it.
[[nodiscard]] FormulaGiven given_of(const FormulaFound& found);

}  // namespace fathom::learning
