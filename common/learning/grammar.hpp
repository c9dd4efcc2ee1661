// Closed forms that a force may have: laws along an axis, products of a base term and a modulator, with an inner number
// (an exponent, a moment, a frequency) that is fitted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/inference/free_force.hpp"

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

/// Forms along the axes of the learned force's groups, and along the world's.
[[nodiscard]] std::vector<Form> grammar(const likelihood::Problem& problem, const model::Scene& scene,
                                        const inference::FreeForceFound& found);

/// Sum of amplitudes times products; `moment`: what stands in place of a moment that is sought.
[[nodiscard]] std::string equation_of(const std::vector<model::Feature>& features, const std::string& moment = {});

}  // namespace fathom::learning
