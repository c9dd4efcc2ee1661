// Least squares under a residual with a memory of several samples (autoregressive of third order), from sums of
// products that are taken once: every subset of columns follows from them. Unlike plain least squares it is not
// deceived when the regressors answer to the residual's past, as thrust does that a pilot or an autopilot gives (Ljung,
// System Identification, 1999, ch. 13.4). autoregression.hpp does the same for a memory of one sample, with standard
// errors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace fathom::identification {

/// Sums of products of rows z_n and their predecessors z_n-1 .. z_n-3, over all n for which these four are finite.
class LagSums {
 public:
  static constexpr Eigen::Index kMemory = 3;

  explicit LagSums(Eigen::Index columns);
  /// Rows of one run at equal steps. A row that is not finite is a gap.
  void add(const Eigen::MatrixXd& rows);

  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] Eigen::Index columns() const { return columns_; }
  /// sum z_n-i z_n-j', i and j up to kMemory.
  [[nodiscard]] Eigen::MatrixXd product(Eigen::Index i, Eigen::Index j) const;
  /// sum w w' over the chosen columns of the whitened rows w_n = z_n - phi_1 z_n-1 - phi_2 z_n-2 - phi_3 z_n-3.
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::Vector3d& phi, const std::vector<Eigen::Index>& columns) const;
  /// phi that foretells the combination z c best from its own past.
  [[nodiscard]] Eigen::Vector3d memory_of(const Eigen::VectorXd& c, const std::vector<Eigen::Index>& columns) const;

 private:
  Eigen::Index columns_;
  int samples_{};
  std::array<std::array<Eigen::MatrixXd, kMemory + 1>, kMemory + 1> products_;  // of i <= j
};

struct ColouredFit {
  Eigen::VectorXd x;  ///< coefficients of the chosen columns
  Eigen::Vector3d phi{
      Eigen::Vector3d::Zero()};  ///< of the residual: e_n = phi_1 e_n-1 + phi_2 e_n-2 + phi_3 e_n-3 + a_n
  double sse{};                  ///< sum a_n^2
  int rank{};                    ///< of the whitened columns
};

/// Column `target` on the chosen columns, by turns with phi (Cochrane and Orcutt 1949). Collinear columns share.
[[nodiscard]] ColouredFit fit_coloured(const LagSums& sums, const std::vector<Eigen::Index>& columns,
                                       Eigen::Index target);

}  // namespace fathom::identification
