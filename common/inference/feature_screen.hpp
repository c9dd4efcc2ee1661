// The linear screen of groups of features: their columns through a seen model's filter, and what groups of them would
// be worth, each with a variance of its own.
#pragma once

#include <span>

#include "common/inference/scan.hpp"

namespace fathom::inference {

constexpr double kStartSigma = 0.03;  ///< of the applied wrench: weights before their group's variance is known

using ColumnRange = std::pair<Eigen::Index, Eigen::Index>;  ///< first and count

struct Screen {
  std::vector<std::size_t> groups;  ///< of the library
  std::vector<ColumnRange> ranges;  ///< of the columns
  Eigen::MatrixXd gram;             ///< the model's own numbers projected out
  Eigen::VectorXd gradient;
};

/// Sums over columns with the model's own numbers projected out: they move along with what is asked.
struct Projected {
  Eigen::MatrixXd gram;
  Eigen::VectorXd gradient;
};
[[nodiscard]] Projected project(const Seen& seen, const likelihood::ResponseSums& sums);

/// Of these groups of the library. `all`: products between groups too.
[[nodiscard]] Screen screen(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& library,
                            const std::vector<std::size_t>& groups, bool all);

/// Groups that pass through the filter together.
[[nodiscard]] std::vector<std::vector<std::size_t>> batches_of(const likelihood::FreeForce& library);

/// Nats for having chosen a group among `of`.
[[nodiscard]] double price(const likelihood::FeatureGroup& group, std::size_t of, const Thresholds& thresholds);

/// Bayes factor of groups of columns with variances of their own, found by MacKay's rule: gram and gradient of all
/// columns, of which groups [first, first + count) are used.
struct GroupEvidence {
  double log_bayes_factor{};
  std::vector<double> sigma;
  Eigen::VectorXd weight;  ///< of the columns used, in order
};
[[nodiscard]] GroupEvidence group_evidence(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                                           std::span<const ColumnRange> groups, std::vector<double> sigma);

/// Groups of a screen as a force with the weights and variances of their evidence.
[[nodiscard]] likelihood::FreeForce chosen(const likelihood::FreeForce& library, const Screen& screen,
                                           const std::vector<std::size_t>& picked, const GroupEvidence& evidence);

/// sigma^2 := |w|^2 / (n - tr(Sigma) / sigma^2) for every group of a fit's force, MacKay 1992.
void renew_sigmas(likelihood::Fit& fit);

/// What the force adds at the seen states.
[[nodiscard]] Size size_of_force(const likelihood::Problem& problem, const Seen& seen,
                                 const likelihood::FreeForce& force);

}  // namespace fathom::inference
