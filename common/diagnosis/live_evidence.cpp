// r = y - Y b + c(theta), c linear around each start: c0 + J delta. With b eliminated (Schur complement of the normal
// equations) each candidate is a small ridge regression on what the base cannot imitate.
#include "common/diagnosis/live_evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/diagnosis/evidence.hpp"

namespace fathom::diagnosis {
namespace {

constexpr Eigen::Index kTogether = 12;  // rows
constexpr double kMemory = 0.3;         // correlation over two instants: far from white
constexpr double kSignificance = 4.0;   // standard errors of that correlation
constexpr double kSmallestMassRatio = 0.1, kNoMass = 0.03;
constexpr double kNegligible = 0.01;  // of the applied wrench's variance

}  // namespace

LiveEvidence::LiveEvidence(const LiveCandidates& candidates, const Eigen::VectorXd& prior_information,
                           std::vector<Mass> masses, std::size_t most_blocks)
    : candidates_{candidates},
      prior_information_{prior_information},
      masses_{std::move(masses)},
      most_blocks_{most_blocks},
      base_{prior_information.size()},
      size_{base_ + 1 + candidates.columns()} {
  Eigen::Index at = 0;
  for (const LiveStart& start : candidates.starts()) {
    within_at_.push_back(at);
    at += start.columns() * start.columns();
  }
  within_at_.push_back(at);
  total_.setZero(size_, size_);
  waiting_.setZero(size_, kTogether);
  open_ = empty_block();
  for (AxisMemory& memory : memory_) {
    memory.now.setZero(base_ + 1, base_ + 1);
    memory.lagged.setZero(base_ + 1, base_ + 1);
  }
  blocks_.reserve(most_blocks_ + 1);
}

LiveEvidence::Block LiveEvidence::empty_block() const {
  return {
      .head = Eigen::MatrixXd::Zero(base_ + 1, size_), .within = Eigen::VectorXd::Zero(within_at_.back()), .rows = 0};
}

void LiveEvidence::add(int axis, const Eigen::Ref<const Eigen::VectorXd>& row, double applied) {
  if (waits_ == waiting_.cols()) sum_up();
  waiting_.col(waits_++) = row;
  open_.head.noalias() += row.head(base_ + 1) * row.transpose();
  for (std::size_t s = 0; s < candidates_.starts().size(); ++s) {
    const LiveStart& start = candidates_.starts()[s];
    const Eigen::Index n = start.columns();
    const auto own = row.segment(base_ + 1 + start.column, n);
    Eigen::Map<Eigen::MatrixXd>{open_.within.data() + within_at_[s], n, n}.noalias() += own * own.transpose();
  }
  ++open_.rows;
  ++rows_;
  AxisMemory& memory = memory_[static_cast<std::size_t>(axis)];
  const auto head = row.head(base_ + 1);
  memory.now.noalias() += head * head.transpose();
  memory.applied += applied * applied;
  if (memory.last[2].size() > 0) {
    memory.lagged.noalias() += memory.last[2] * head.transpose();
    ++memory.pairs;
  }
  memory.last[0] = head;
}

// A thousand columns are megabytes, which are walked once for several rows: a column stays near meanwhile. Each product
// is added by itself and in the rows' order. Many candidates have no part in many axes.
void LiveEvidence::sum_up() {
  for (Eigen::Index column = 0; column < size_; ++column) {
    for (Eigen::Index k = 0; k < waits_; ++k) {
      const double factor = waiting_(column, k);
      if (factor != 0.0) total_.col(column).head(column + 1) += factor * waiting_.col(k).head(column + 1);
    }
  }
  waits_ = 0;
}

void LiveEvidence::next_instant() {
  for (AxisMemory& memory : memory_) {
    std::swap(memory.last[2], memory.last[1]);
    std::swap(memory.last[1], memory.last[0]);
    memory.last[0].resize(0);
  }
}

void LiveEvidence::close_block() {
  if (open_.rows == 0) return;
  // Blocks must stay of one length, since the odds count them alike: after a merge twice as much goes into each.
  if (++open_parts_ >= parts_per_block_) {
    if (blocks_.size() >= most_blocks_) {
      for (std::size_t i = 0; i + 1 < blocks_.size(); i += 2) {
        Block& merged = blocks_[i / 2];
        if (i > 0) std::swap(merged, blocks_[i]);
        merged.head += blocks_[i + 1].head;
        merged.within += blocks_[i + 1].within;
      }
      blocks_.resize(blocks_.size() / 2);  // an odd one out is dropped from the blocks, not from the sums
      parts_per_block_ *= 2;
    } else {
      blocks_.push_back(open_);
      open_.head.setZero();
      open_.within.setZero();
      open_.rows = 0;
      open_parts_ = 0;
    }
  }
  projected_.resize(0, 0);
}

void LiveEvidence::project() {
  sum_up();
  const Eigen::Index rest = size_ - base_;
  Eigen::MatrixXd normal = total_.topLeftCorner(base_, base_).selfadjointView<Eigen::Upper>();
  normal.diagonal() += prior_information_;
  const auto cross = total_.topRightCorner(base_, rest);
  imitation_ = normal.ldlt().solve(Eigen::MatrixXd{cross});
  projected_ = total_.bottomRightCorner(rest, rest).selfadjointView<Eigen::Upper>();
  projected_.noalias() -= cross.transpose() * imitation_;
  const double variance = std::max(projected_(0, 0) / std::max<double>(1.0, rows_ - static_cast<double>(base_)), 1e-12);
  scale_ = 1.0 / variance;
  projected_ *= scale_;
}

double LiveEvidence::block_cost(const Block& block, const LiveStart* start, const Eigen::VectorXd& base,
                                const Eigen::VectorXd& own) const {
  const Eigen::VectorXd against_base = block.head.leftCols(base_ + 1) * base;
  double square = base.dot(against_base);
  if (start != nullptr) {
    const Eigen::Index n = start->columns();
    const auto s = static_cast<std::size_t>(start - candidates_.starts().data());
    square += 2.0 * base.dot(block.head.middleCols(base_ + 1 + start->column, n) * own);
    square += own.dot(Eigen::Map<const Eigen::MatrixXd>{block.within.data() + within_at_[s], n, n} * own);
  }
  return 0.5 * scale_ * square;
}

// Ridge regression inside bounds: a number that would leave its bounds is put there, and the others are found anew.
LiveSuspicion LiveEvidence::fit(const LiveStart& start, double& cost) const {
  const LiveForm& form = candidates_.forms()[static_cast<std::size_t>(start.form)];
  const auto& parameters = form.parameters;
  const Eigen::Index k = start.columns() - 1;
  const Eigen::Index at = 1 + start.column;
  const Eigen::MatrixXd J = projected_.block(at + 1, at + 1, k, k);
  const Eigen::VectorXd slope = projected_.block(at + 1, 0, k, 1) + projected_.block(at + 1, at, k, 1);
  Eigen::VectorXd theta(k);  // at the start, in sigmas
  const auto number = [&](Eigen::Index i) { return form.sought[static_cast<std::size_t>(i)]; };
  for (Eigen::Index i = 0; i < k; ++i) theta[i] = start.theta[number(i)] / parameters[number(i)].sigma;
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(k);
  std::vector<bool> fixed(static_cast<std::size_t>(k), false);
  for (Eigen::Index round = 0; round <= k; ++round) {
    Eigen::MatrixXd normal = J + Eigen::MatrixXd::Identity(k, k);
    Eigen::VectorXd right = -(slope + theta);
    for (Eigen::Index i = 0; i < k; ++i) {
      if (!fixed[static_cast<std::size_t>(i)]) continue;
      right -= normal.col(i) * delta[i];
      normal.row(i).setZero();
      normal.col(i).setZero();
      normal(i, i) = 1.0;
      right[i] = delta[i];
    }
    for (Eigen::Index i = 0; i < k; ++i) {
      if (fixed[static_cast<std::size_t>(i)]) right[i] = delta[i];
    }
    delta = normal.ldlt().solve(right);
    bool inside = true;
    for (Eigen::Index i = 0; i < k; ++i) {
      const auto j = static_cast<std::size_t>(i);
      const model::EffectParameter& own = parameters[number(i)];
      const double low = own.low / own.sigma - theta[i];
      const double high = own.high / own.sigma - theta[i];
      if (fixed[j] || (delta[i] >= low && delta[i] <= high)) continue;
      delta[i] = std::clamp(delta[i], low, high);
      fixed[j] = true;
      inside = false;
    }
    if (inside) break;
  }
  LiveSuspicion found{.form = start.form, .theta = start.theta, .coefficients = Eigen::VectorXd::Zero(size_ - base_)};
  for (Eigen::Index i = 0; i < k; ++i) found.theta[number(i)] += delta[i] * parameters[number(i)].sigma;
  found.coefficients[at] = 1.0;
  found.coefficients.segment(at + 1, k) = delta;
  const Eigen::VectorXd own = found.coefficients.segment(at, k + 1);
  cost = 0.5 * projected_(0, 0) + projected_.row(0).segment(at, k + 1).dot(own) +
         0.5 * own.dot(projected_.block(at, at, k + 1, k + 1) * own);
  return found;
}

// The noise is in the motion, so in wrench it grows with the masses: a candidate that takes thrust away, and masses
// with it, shrinks every residual and explains nothing. Its cost is therefore judged at the masses without it, by the
// axis that shrinks most (cautious for the other axes). A lag does shrink what had been taken for inertia, to a tenth
// and less, so that this has an end; but where next to nothing is left of a mass, thrust, drag and weight of its axis
// have gone as well, and any residual with them.
std::optional<double> LiveEvidence::shrinkage(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const {
  double smallest = 1.0;
  for (const Mass& mass : masses_) {
    const double before = mass.prior_mean + without[mass.column];
    if (before > 0.0) smallest = std::min(smallest, (mass.prior_mean + with[mass.column]) / before);
  }
  if (smallest < kNoMass) return std::nullopt;
  return 1.0 / std::pow(std::max(smallest, kSmallestMassRatio), 2);
}

std::vector<LiveSuspicion> LiveEvidence::judge() {
  if (projected_.size() == 0) project();
  std::vector<LiveSuspicion> judged;
  if (blocks_.empty()) return judged;
  const auto& starts = candidates_.starts();
  const auto tried = static_cast<int>(candidates_.forms().size());
  Eigen::VectorXd base(base_ + 1);
  base << -imitation_.col(0), 1.0;
  std::vector<double> without(blocks_.size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) without[b] = block_cost(blocks_[b], nullptr, base, {});
  const double cost_without = 0.5 * projected_(0, 0);
  for (std::size_t s = 0; s < starts.size();) {
    const int form = starts[s].form;
    const LiveStart* best_start = nullptr;
    double best_cost = cost_without, best_penalty = 1.0;  // the cost as it is, without the penalty
    Eigen::VectorXd best_base;
    LiveSuspicion best{.form = form,
                       .theta = starts[s].theta,
                       .block_cost = without,
                       .coefficients = Eigen::VectorXd::Zero(size_ - base_)};
    for (; s < starts.size() && starts[s].form == form; ++s) {
      double cost = 0.0;
      LiveSuspicion found = fit(starts[s], cost);
      Eigen::VectorXd weights = found.coefficients;
      weights[0] = 1.0;
      base << -(imitation_ * weights), 1.0;
      const std::optional<double> penalty = shrinkage(imitation_.col(0), -base.head(base_));
      if (!penalty || (best_start != nullptr && cost >= best_cost)) continue;
      best_start = &starts[s];
      best_cost = cost;
      best_penalty = *penalty;
      best_base = base;
      best = std::move(found);
    }
    if (best_start != nullptr) {
      const Eigen::VectorXd own = best.coefficients.segment(1 + best_start->column, best_start->columns());
      best.block_cost.resize(blocks_.size());
      for (std::size_t b = 0; b < blocks_.size(); ++b)
        best.block_cost[b] = best_penalty * block_cost(blocks_[b], best_start, best_base, own);
    }
    const LiveForm& asked = candidates_.forms()[static_cast<std::size_t>(form)];
    best.log_odds = log_odds(without, best.block_cost, asked.effect->numbers(asked.variant), tried);
    best.error_reduction = 1.0 - std::sqrt(std::clamp(best_penalty * best_cost / cost_without, 0.0, 1.0));
    judged.push_back(std::move(best));
  }
  std::stable_sort(judged.begin(), judged.end(),
                   [](const LiveSuspicion& a, const LiveSuspicion& b) { return a.log_odds > b.log_odds; });
  return judged;
}

double LiveEvidence::likeness(const LiveSuspicion& a, const LiveSuspicion& b) const {
  const double aa = a.coefficients.dot(projected_ * a.coefficients);
  const double bb = b.coefficients.dot(projected_ * b.coefficients);
  return aa > 0.0 && bb > 0.0 ? a.coefficients.dot(projected_ * b.coefficients) / std::sqrt(aa * bb) : 0.0;
}

bool LiveEvidence::structured() {
  if (blocks_.empty()) return false;
  if (projected_.size() == 0) project();
  Eigen::VectorXd base(base_ + 1);
  base << -imitation_.col(0), 1.0;
  return std::any_of(memory_.begin(), memory_.end(), [&](const AxisMemory& memory) {
    const double square = base.dot(memory.now * base);
    if (square <= kNegligible * memory.applied || square <= 0.0) return false;
    const double correlation = base.dot(memory.lagged * base) / square;
    return correlation > kMemory && correlation * std::sqrt(static_cast<double>(memory.pairs)) > kSignificance;
  });
}

}  // namespace fathom::diagnosis
