// "Something that no list holds" on the same scale as everything else: a seen model plus a free force with Gaussian
// priors per group, noise fitted anew beside it. The force found is part of the hypothesis, ready to be adopted.
#pragma once

#include <span>

#include "common/base/deadline.hpp"
#include "common/inference/feature_library.hpp"

namespace fathom::inference {

/// A group that was taken up, and what it was worth when it was.
struct GroupFound {
  std::string kind;
  int axis{};     ///< Feature::axis
  double gain{};  ///< nats that it is worth beside the others, after its price
};

struct FreeForceFound {
  std::vector<GroupFound> groups;   ///< what is worth most first
  double log_odds{};                ///< over the model without it, prices paid: the larger of both ways
  double at_fixed_noise{};          ///< of the linear screen alone
  std::vector<double> explainable;  ///< per simulated axis: share of the random force's variance that it takes away
  Size size{};                      ///< share of the applied acceleration
  likelihood::Fit fit{};            ///< with the force; finite only where it was fitted
};

/// `relatives`: effects that the seen model lacks and in whose place the force is asked, with their numbers. A group
/// that is the same thing by another name is no rival of theirs and is left out.
[[nodiscard]] FreeForceFound find_free_force(const likelihood::Problem& problem, const Seen& seen,
                                             const model::Scene& scene, const Thresholds& thresholds, int threads,
                                             const Deadline& deadline = {},
                                             std::span<const model::ActiveEffect> relatives = {});

/// "depth in Z", "place, toward north": the group in words.
[[nodiscard]] std::string words(const GroupFound& group);

/// Bayes factor of groups of columns with variances of their own, found by MacKay's rule: gram and gradient of all
/// columns, of which groups [first, first + count) are used.
struct GroupEvidence {
  double log_bayes_factor{};
  std::vector<double> sigma;
  Eigen::VectorXd weight;  ///< of the columns used, in order
};
[[nodiscard]] GroupEvidence group_evidence(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                                           std::span<const std::pair<Eigen::Index, Eigen::Index>> groups,
                                           std::vector<double> sigma);

}  // namespace fathom::inference
