// Which groups of the library a fit is begun with: by the screen, one after the other.
#pragma once

#include "common/inference/scan.hpp"
#include "common/learning/products.hpp"
#include "common/likelihood/features.hpp"

namespace fathom::learning {

struct Picked {
  likelihood::FreeForce force;
  double log_odds{};    ///< nats of all together, prices paid
  std::size_t among{};  ///< groups of the library, which their prices go by
};

struct Picking {
  std::size_t most{};  ///< groups
  Clock clock{Clock::kLasting};
  bool at_least_one{false};  ///< where nothing stands out, the best: the random force may have swallowed it
  int threads{1};
};

/// Groups that are worth more than they cost, one after the other, those that have become superfluous taken back.
[[nodiscard]] Picked pick_groups(const likelihood::Problem& problem, const inference::Seen& seen,
                                 const model::Scene& scene, const Picking& how);

}  // namespace fathom::learning
