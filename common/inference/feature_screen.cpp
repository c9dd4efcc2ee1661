#include "common/inference/feature_screen.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/base/factors.hpp"
#include "common/inference/feature_columns.hpp"

namespace fathom::inference {
namespace {

constexpr double kLeastSigma = 1e-4;
constexpr double kMostSigma =
    1.0;  // groups that nearly cancel would else stand for anything with weights of thousands of per cent
constexpr int kTurns = 5;   // of the variances
constexpr int kBatch = 48;  // columns that pass through the filter together

}  // namespace

Projected project(const Seen& seen, const likelihood::ResponseSums& sums) {
  const Eigen::MatrixXd& X = sums.with_numbers;
  Projected projected{sums.gram.selfadjointView<Eigen::Lower>(), sums.gradient - X.transpose() * seen.step};
  projected.gram -= X.transpose() * (seen.covariance * X);
  return projected;
}

Screen screen(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& library,
              const std::vector<std::size_t>& groups, bool all) {
  Screen screen{.groups = groups};
  std::vector<std::size_t> beginnings;
  std::size_t columns = 0;
  for (const std::size_t g : groups) {
    beginnings.push_back(columns);
    screen.ranges.emplace_back(static_cast<Eigen::Index>(columns), library.groups[g].count);
    columns += static_cast<std::size_t>(library.groups[g].count);
  }
  likelihood::ResponseSums sums;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    FeatureColumns features{problem, seen, library, groups, r};
    likelihood::respond(
        problem, seen.reference[r], r, columns, all ? std::span<const std::size_t>{} : beginnings,
        [&](std::size_t block, likelihood::ColumnsOut acceleration, likelihood::ColumnsOut) {
          features.at(block, acceleration);
        },
        sums);
  }
  Projected projected = project(seen, sums);
  screen.gram = std::move(projected.gram);
  screen.gradient = std::move(projected.gradient);
  return screen;
}

std::vector<std::vector<std::size_t>> batches_of(const likelihood::FreeForce& library) {
  std::vector<std::vector<std::size_t>> batches;
  int columns = kBatch;
  for (std::size_t g = 0; g < library.groups.size(); ++g) {
    if (columns + library.groups[g].count > kBatch) {
      batches.emplace_back();
      columns = 0;
    }
    batches.back().push_back(g);
    columns += library.groups[g].count;
  }
  return batches;
}

double price(const likelihood::FeatureGroup& group, std::size_t of, const Thresholds& thresholds) {
  return thresholds.group_price + std::log(static_cast<double>(of)) +
         (group.searched ? thresholds.searched_price : 0.0);
}

likelihood::FreeForce chosen(const likelihood::FreeForce& library, const Screen& screen,
                             const std::vector<std::size_t>& picked, const GroupEvidence& evidence) {
  likelihood::FreeForce force;
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < picked.size(); ++k) {
    likelihood::FeatureGroup group = library.groups[screen.groups[picked[k]]];
    const int from = group.first;
    group.first = static_cast<int>(force.features.size());
    group.sigma = evidence.sigma[k];
    for (int j = 0; j < group.count; ++j) {
      force.features.push_back(library.features[static_cast<std::size_t>(from + j)]);
      force.weights.push_back(evidence.weight[at++]);
    }
    force.groups.push_back(std::move(group));
  }
  return force;
}

void renew_sigmas(likelihood::Fit& fit) {
  const Eigen::MatrixXd covariance = inverse_symmetric(fit.information);
  std::size_t first = 0;
  while (first < fit.numbers.size() && fit.numbers[first].kind != likelihood::NumberKind::kWeight) ++first;
  for (likelihood::FeatureGroup& group : fit.hypothesis.force.groups) {
    double square = 0.0, open = 0.0;
    for (int j = group.first; j < group.first + group.count; ++j) {
      const double w = fit.hypothesis.force.weights[static_cast<std::size_t>(j)];
      const auto at = static_cast<Eigen::Index>(first) + j;
      square += w * w;
      open += covariance(at, at);
    }
    const double known = std::max(group.count - open / (group.sigma * group.sigma), 0.1);
    group.sigma = std::clamp(std::sqrt(square / known), kLeastSigma, kMostSigma);
  }
}

GroupEvidence group_evidence(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                             std::span<const ColumnRange> groups, std::vector<double> sigma) {
  std::vector<Eigen::Index> columns;
  for (const auto& [first, count] : groups) {
    for (Eigen::Index j = 0; j < count; ++j) columns.push_back(first + j);
  }
  const Eigen::MatrixXd G = gram(columns, columns);
  const Eigen::VectorXd b = gradient(columns);
  GroupEvidence best{.log_bayes_factor = -1e300, .sigma = sigma};
  for (int turn = 0; turn < kTurns; ++turn) {
    Eigen::VectorXd D(static_cast<Eigen::Index>(columns.size()));
    Eigen::Index at = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (Eigen::Index j = 0; j < groups[g].second; ++j) D[at++] = sigma[g];
    }
    Eigen::MatrixXd scaled = D.asDiagonal() * G * D.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const SymmetricFactor factor{scaled};
    const Eigen::VectorXd pivots = factor.pivots();
    const Eigen::VectorXd x = factor.solve(D.cwiseProduct(b));
    double value = 0.5 * D.cwiseProduct(b).dot(x);
    for (Eigen::Index j = 0; j < D.size(); ++j) value -= 0.5 * std::log(std::max(pivots[j], 1e-300));
    if (std::isfinite(value) && value > best.log_bayes_factor) best = {value, sigma, D.cwiseProduct(x)};
    const Eigen::MatrixXd inverse = factor.inverse();
    at = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      double square = 0.0, open = 0.0;
      for (Eigen::Index j = 0; j < groups[g].second; ++j, ++at) {
        square += D[at] * x[at] * D[at] * x[at];
        open += inverse(at, at);
      }
      const double known = std::max(static_cast<double>(groups[g].second) - open, 0.1);
      sigma[g] = std::clamp(std::sqrt(square / known), kLeastSigma, kMostSigma);
    }
  }
  return best;
}

Size size_of_force(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& force) {
  std::vector<std::size_t> groups(force.groups.size());
  std::iota(groups.begin(), groups.end(), std::size_t{0});
  const Eigen::Map<const Eigen::VectorXd> w{force.weights.data(), static_cast<Eigen::Index>(force.weights.size())};
  std::vector<Eigen::MatrixXd> accelerations;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    FeatureColumns features{problem, seen, force, groups, r};
    const auto blocks = static_cast<Eigen::Index>(problem.runs[r].blocks().size());
    likelihood::RowMatrix columns(seen.reference[r].axes, static_cast<Eigen::Index>(features.size()));
    Eigen::MatrixXd sum(columns.rows(), blocks);
    for (Eigen::Index b = 0; b < blocks; ++b) {
      features.at(static_cast<std::size_t>(b), columns);
      sum.col(b) = columns * w;
    }
    accelerations.push_back(std::move(sum));
  }
  return size_of_missing(problem, seen, accelerations);
}

}  // namespace fathom::inference
