// Regression evidence of all candidates at once, from rows that arrive one by one: products per block of time, the base
// parameters projected out at evaluation, and odds that count blocks, not rows. Memory is bounded: old blocks are
// merged.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/diagnosis/live_candidates.hpp"

namespace fathom::diagnosis {

/// A form with the best numbers found for it.
struct LiveSuspicion {
  int form{};
  std::vector<double> theta;
  double log_odds{};
  double error_reduction{};
  std::vector<double> block_cost;
  Eigen::VectorXd coefficients;  ///< over [y | candidates' columns]: the part of y that it explains, y itself excluded
};

class LiveEvidence {
 public:
  /// A mass among the base parameters.
  struct Mass {
    Eigen::Index column{};
    double prior_mean{};
  };
  /// `prior_information`: inverse variances of the base parameters, which are counted from their prior means.
  LiveEvidence(const LiveCandidates& candidates, const Eigen::VectorXd& prior_information, std::vector<Mass> masses,
               std::size_t most_blocks);

  /// Row = [base | y | candidates], already divided by its standard deviation; `applied` likewise.
  void add(int axis, const Eigen::Ref<const Eigen::VectorXd>& row, double applied);
  /// Call between instants, so that rows are compared with those two instants before (windows that share no sample).
  void next_instant();
  /// One more part of a block is complete; what judge() told before no longer holds.
  void close_block();
  /// Takes the base parameters out of all products, for judge(). Megabytes, and milliseconds: not for who is behind.
  void project();
  [[nodiscard]] std::size_t blocks() const { return blocks_.size(); }

  /// Best numbers and odds per form, highest odds first.
  [[nodiscard]] std::vector<LiveSuspicion> judge();
  /// Cosine between what two candidates explain, the base parameters' share taken out.
  [[nodiscard]] double likeness(const LiveSuspicion& a, const LiveSuspicion& b) const;
  /// True when what the base model leaves on an axis has memory and is not negligible beside the applied wrench.
  [[nodiscard]] bool structured();

 private:
  struct Block {
    Eigen::MatrixXd head;    // [base | y] against all columns
    Eigen::VectorXd within;  // per start, its columns against each other
    int rows{};
  };
  struct AxisMemory {
    Eigen::MatrixXd now, lagged;  // [base | y] against itself, at once and two instants later
    std::array<Eigen::VectorXd, 3> last;
    int pairs{};
    double applied{};
  };
  [[nodiscard]] std::optional<double> shrinkage(const Eigen::VectorXd& without, const Eigen::VectorXd& with) const;
  [[nodiscard]] double block_cost(const Block& block, const LiveStart* start, const Eigen::VectorXd& base,
                                  const Eigen::VectorXd& own) const;
  [[nodiscard]] LiveSuspicion fit(const LiveStart& start, double& cost) const;
  [[nodiscard]] Block empty_block() const;
  void sum_up();

  const LiveCandidates& candidates_;
  Eigen::VectorXd prior_information_;
  std::vector<Mass> masses_;
  std::size_t most_blocks_;
  Eigen::Index base_;
  Eigen::Index size_;
  std::vector<Eigen::Index> within_at_;
  Eigen::MatrixXd total_;    // upper triangle
  Eigen::MatrixXd waiting_;  // rows of an instant, as columns, that total_ lacks
  Eigen::Index waits_{};
  std::vector<Block> blocks_;
  Block open_;
  int open_parts_{};
  int parts_per_block_{1};
  std::array<AxisMemory, 6> memory_;
  int rows_{};
  // Of the last evaluation:
  Eigen::MatrixXd imitation_;  // base parameters that imitate [y | candidates]
  Eigen::MatrixXd projected_;  // products of [y | candidates] with the base taken out, over the residual's variance
  double scale_{1.0};          // 1 / variance of the residual
};

}  // namespace fathom::diagnosis
