// Curvature of an objective as its own steps tell it, where the expected information is far from it: a model that lacks
// something and densities with tails leave it a tenth of that along some directions, in which steps by the information
// alone creep.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace fathom::likelihood {

/// The structured secant update of Dennis, Gay and Welsch 1981 (NL2SOL, ACM TOMS 7, 348-368).
class Curvature {
 public:
  /// `information` (p x p): expected, where the step `s` (p) ended; `y` (p): by how much the slope fell over it.
  void learn(const Eigen::MatrixXd& information, const Eigen::VectorXd& s, const Eigen::VectorXd& y);
  /// The information with what steps have told; nothing where that is not positive definite, or there were no steps.
  [[nodiscard]] std::optional<Eigen::MatrixXd> corrected(const Eigen::MatrixXd& information) const;
  void forget() { beyond_.resize(0, 0); }

 private:
  Eigen::MatrixXd beyond_;  // curvature less the information; empty: nothing known
};

}  // namespace fathom::likelihood
