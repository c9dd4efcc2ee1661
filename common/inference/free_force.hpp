// "Something that no list holds" on the same scale as everything else: a seen model plus a free force with Gaussian
// priors per group, noise fitted anew beside it. The force found is part of the hypothesis, ready to be adopted.
#pragma once

#include "common/base/deadline.hpp"
#include "common/inference/scan.hpp"

namespace fathom::inference {

/// A group that was taken up, and what it was worth when it was.
struct GroupFound {
  std::string kind;
  int axis{};     ///< Feature::axis
  double gain{};  ///< nats, after its price
};

struct FreeForceFound {
  std::vector<GroupFound> groups;   ///< in the order of acceptance
  double log_odds{};                ///< over the model without it, prices paid: the larger of both ways
  double at_fixed_noise{};          ///< of the linear screen alone
  std::vector<double> explainable;  ///< per simulated axis: share of the random force's variance that it takes away
  Size size{};                      ///< share of the applied acceleration
  likelihood::Fit fit{};            ///< with the force; finite only where it was fitted
};

[[nodiscard]] FreeForceFound find_free_force(const likelihood::Problem& problem, const Seen& seen,
                                             const model::Scene& scene, const Thresholds& thresholds, int threads,
                                             const Deadline& deadline = {});

/// "depth in Z", "place, toward north": the group in words.
[[nodiscard]] std::string words(const GroupFound& group);

}  // namespace fathom::inference
