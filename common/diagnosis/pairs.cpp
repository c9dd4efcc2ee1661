#include "common/diagnosis/pairs.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::diagnosis {
namespace {

constexpr double kAlike = 0.95;  // correlation beyond which two changes are one

bool same_effects(const Answers& answers, const Pair& one, const Pair& other) {
  const auto effect = [&](std::size_t place) { return answers.near[place].effect; };
  return (effect(one.first) == effect(other.first) && effect(one.second) == effect(other.second)) ||
         (effect(one.first) == effect(other.second) && effect(one.second) == effect(other.first));
}

/// Forms of one effect, unless it can act in both at once.
bool one_or_the_other(const Screened& one, const Screened& other) {
  return one.effect == other.effect &&
         (!one.effect->variants_matter() || one.effect->rules_out(one.variant, other.variant));
}

/// The least share (RMS) of what is unexplained that is left along an axis.
double least_left(const Answers& answers, const Pair& pair) {
  const Screened &one = answers.near[pair.first], &other = answers.near[pair.second];
  const Eigen::VectorXd left = answers.unexplained + pair.of_first * one.change * one.signature +
                               pair.of_second * other.change * other.signature;
  Vector6d before = Vector6d::Zero(), after = Vector6d::Zero();
  for (Eigen::Index row = 0; row < left.size(); ++row) {
    before[answers.axis[row]] += answers.unexplained[row] * answers.unexplained[row];
    after[answers.axis[row]] += left[row] * left[row];
  }
  double least = 1.0;
  for (int axis = 0; axis < 6; ++axis) {
    if (before[axis] > 0.0) least = std::min(least, std::sqrt(after[axis] / before[axis]));
  }
  return least;
}

}  // namespace

std::vector<Pair> promising_pairs(const Answers& answers, std::size_t most) {
  const auto n = static_cast<Eigen::Index>(answers.near.size());
  Eigen::MatrixXd changes(answers.unexplained.size(), n);
  for (Eigen::Index i = 0; i < n; ++i) changes.col(i) = answers.near[static_cast<std::size_t>(i)].signature;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);  // of i <= j
  products.selfadjointView<Eigen::Upper>().rankUpdate(changes.transpose());
  const Eigen::VectorXd with = -changes.transpose() * answers.unexplained;
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i + 1; j < n; ++j) {
      const Screened &one = answers.near[static_cast<std::size_t>(i)],
                     &other = answers.near[static_cast<std::size_t>(j)];
      const double alike = products(i, j);
      if (one_or_the_other(one, other) || !(one.change > 0.0) || !(other.change > 0.0) || std::abs(alike) > kAlike)
        continue;
      const double free = 1.0 - alike * alike;
      const double of_one = (with[i] - alike * with[j]) / free, of_other = (with[j] - alike * with[i]) / free;
      const double gain = 0.5 * (of_one * with[i] + of_other * with[j]);
      pairs.push_back({static_cast<std::size_t>(i), static_cast<std::size_t>(j),
                       reduction(answers.cost, answers.cost - gain), 1.0, of_one / one.change,
                       of_other / other.change});
    }
  }
  std::ranges::stable_sort(pairs, std::greater{}, &Pair::share);
  std::vector<Pair> best;
  for (const Pair& pair : pairs) {
    if (best.size() == most) break;
    if (std::ranges::none_of(best, [&](const Pair& other) { return same_effects(answers, pair, other); }))
      best.push_back(pair);
  }
  for (Pair& pair : best) pair.least_left = least_left(answers, pair);
  return best;
}

}  // namespace fathom::diagnosis
