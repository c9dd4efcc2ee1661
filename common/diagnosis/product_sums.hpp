// Least squares of a series on columns, by sums of their products: every choice of columns follows from one sum.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/identification/lag_sums.hpp"

namespace fathom::diagnosis {

using Indices = std::vector<Eigen::Index>;
/// From the first to the one before the second.
[[nodiscard]] Indices range(Eigen::Index from, Eigen::Index to);
[[nodiscard]] identification::LagSums sums_of(const std::vector<Eigen::MatrixXd>& runs);

/// Columns but the first and the last: mean removed and brought to the size of one, so that sums do not cancel.
void standardise(std::vector<Eigen::MatrixXd>& runs);
/// Least squares by sums of products: what the columns `free` take up of `right`. Collinear columns share.
[[nodiscard]] Eigen::VectorXd taken_up(const Eigen::MatrixXd& products, const Indices& free,
                                       const Eigen::VectorXd& right);
/// Least sum of squares of the target when the columns `free` may take up what they like, and the others keep `fixed`.
[[nodiscard]] double square_left(const Eigen::MatrixXd& products, const Indices& free, const Indices& held,
                                 const Eigen::VectorXd& fixed);

}  // namespace fathom::diagnosis
