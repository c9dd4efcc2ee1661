// Sums of products from which least squares under a first-order autoregressive residual follows for every subset of
// columns and every phi, without another pass over the samples. Kept by blocks, for bootstrap and for standard errors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace fathom::identification {

/// Rows z_n = (A_n, b_n) of one stretch of equal time steps; the last column is b.
using Samples = Eigen::Ref<const Eigen::MatrixXd>;

/// Sums over a few consecutive samples n and their predecessors.
struct BlockGram {
  Eigen::MatrixXd steps;   ///< sum (z_n - z_n-1)(z_n - z_n-1)'
  Eigen::MatrixXd lagged;  ///< sum z_n-1 z_n-1'
  Eigen::VectorXd before;  ///< z at the sample before the first
  Eigen::VectorXd last;    ///< z at the last sample
  bool opens{false};       ///< `before` is the first sample of its stretch: it counts with 1 - phi^2 (Prais, Winsten)
  int count{};             ///< samples, the opening one included
};

class LaggedGram {
 public:
  /// Columns of A plus one.
  explicit LaggedGram(Eigen::Index columns) : columns_{columns} {}

  /// One stretch without a gap, cut into blocks of about `block` samples. Fewer than two samples are left out.
  void add(const Samples& samples, int block);
  /// What another one holds, too.
  void add(const LaggedGram& other);

  /// sum of w w' over the whitened rows w_n = z_n - phi z_n-1 and sqrt(1 - phi^2) z_1: all columns.
  [[nodiscard]] Eigen::MatrixXd whitened(double phi) const;
  /// The same of one block.
  [[nodiscard]] Eigen::MatrixXd whitened(double phi, const BlockGram& block) const;
  /// sum of z_n z_n', unwhitened.
  [[nodiscard]] Eigen::MatrixXd plain() const { return whitened(0.0); }

  /// For a combination c of the columns with residual e = z c: sums over all stretches.
  struct Residual {
    double square{};  ///< sum e_n^2 over n >= 2
    double lagged{};  ///< sum e_n-1^2 over n >= 2
    double cross{};   ///< sum e_n e_n-1
    double first{};   ///< sum of the stretches' first e^2
  };
  [[nodiscard]] Residual residual(const Eigen::VectorXd& c) const;

  [[nodiscard]] const std::vector<BlockGram>& blocks() const { return blocks_; }
  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] int stretches() const { return stretches_; }
  /// Blocks from `begin` on, `count` of them, as a set of their own.
  [[nodiscard]] LaggedGram part(std::size_t begin, std::size_t count) const;

 private:
  void start();
  void sum(const BlockGram& block);

  Eigen::Index columns_;
  Eigen::MatrixXd steps_, lagged_, ends_, firsts_;
  std::vector<BlockGram> blocks_;
  int samples_{};
  int stretches_{};
};

}  // namespace fathom::identification
