// The search: scan, fit what promises most, take the best, drop and swap, until nothing of practical size is left.
#pragma once

#include <optional>

#include "common/base/deadline.hpp"
#include "common/inference/fitted_models.hpp"
#include "common/inference/free_force.hpp"
#include "common/inference/verdict.hpp"

namespace fathom::inference {

/// What the work tells of itself, with guessed costs in fits of one candidate.
constexpr double kRoundsOfBase = 8.0;                                                ///< guessed
constexpr Step kBaseFit{"base fit", "fitting the base model", 3.0 / kRoundsOfBase};  ///< per round
constexpr Step kScan{"scans", "asking every effect", 2.0};
constexpr Step kFreeForceFit{"free force", "looking for a force that no list holds", 5.0};
constexpr Step kHorizonFit{"horizon", "numbers that predict ten seconds", 4.0};

/// Why a candidate was not taken, at its best.
struct Refused {
  std::string name, form;
  double promised{};  ///< nats by the score test
  std::vector<Refusal> refusals;
};

struct Found {
  Fitted base, best;
  std::vector<double> odds;         ///< per effect of the best: nats over the best without it
  std::vector<double> size;         ///< per effect: share of the applied force, on its worst axis
  std::vector<double> over;         ///< per effect: its force over what is left beside it (Size::over)
  std::vector<double> probability;  ///< per effect: of its name among all that was fitted
  std::vector<double> reliability;  ///< per effect: how often names of such odds are right
  std::vector<std::string> rival;   ///< per effect: the likeliest other name in its place; empty: none came near
  std::vector<Refused> refused;
  std::optional<FreeForceFound> free_force;
  std::vector<Fitted> near;  ///< other sets of names that are hardly less probable than the best
  /// Where the best has more names than `few_effects`: what was found with so few.
  std::vector<Found> fewer;
  int wanted{};  ///< names of a larger model that leaves something all the same; 0: none
  std::size_t fits{};
  bool cut_short{};         ///< the time was over before all was asked
  double spent{}, given{};  ///< s, of a search that was cut short

  /// Of one search, whose time was over or not.
  void ended_as(const Found& other) {
    cut_short = other.cut_short;
    spent = other.spent;
    given = other.given;
  }
};

/// Long recordings: on stretches first, and what was found there on all of them.
[[nodiscard]] Found search(const likelihood::Problem& problem, const model::Scene& scene,
                           const std::vector<std::string>& without, const Thresholds& thresholds, int threads,
                           const Progress& progress, const Deadline& deadline = {});

}  // namespace fathom::inference
