// The search: scan, fit what promises most, take the best, drop and swap, until nothing of practical size is left.
#pragma once

#include <functional>
#include <optional>

#include "common/inference/free_force.hpp"
#include "common/inference/verdict.hpp"

namespace fathom::inference {

using Progress = std::function<void(const std::string&, double)>;

/// A set of effects that was fitted in full.
struct Fitted {
  likelihood::Fit fit;
  std::vector<std::string> names;  ///< of its effects, sorted: what a posterior is about
  double score{};                  ///< log evidence and log prior of the set
};

/// Log prior of a set: of their number, and uniform over sets and over the forms of each.
[[nodiscard]] double log_prior_of_set(const std::vector<model::ActiveEffect>& effects, const std::vector<Law>& laws);

/// Why a candidate was not taken, at its best.
struct Refused {
  std::string name, form;
  double promised{};  ///< nats by the score test
  std::vector<Refusal> refusals;
};

struct Found {
  Fitted base, best;
  std::vector<double> odds;         ///< per effect of the best: nats over the best without it
  std::vector<double> size;         ///< per effect
  std::vector<double> probability;  ///< per effect: that its name is right, among all that was fitted
  std::vector<std::string> rival;   ///< per effect: the likeliest other name in its place; empty: none came near
  std::vector<Refused> refused;
  std::optional<FreeForceFound> free_force;
  std::size_t fits{};
};

[[nodiscard]] Found search(const likelihood::Problem& problem, const model::Scene& scene,
                           const std::vector<std::string>& without, const Thresholds& thresholds, int threads,
                           const Progress& progress);

}  // namespace fathom::inference
