// Least squares of a series on columns, by sums of their products: every choice of columns follows from one sum.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fathom::diagnosis {

using Indices = std::vector<Eigen::Index>;

/// Columns but the first and the last: mean removed and brought to the size of one, so that sums do not cancel.
void standardise(std::vector<Eigen::MatrixXd>& runs);
/// Least squares by sums of products: what the columns `free` take up of `right`. Collinear columns share.
[[nodiscard]] Eigen::VectorXd taken_up(const Eigen::MatrixXd& products, const Indices& free,
                                       const Eigen::VectorXd& right);
/// Least sum of squares of the target when the columns `free` may take up what they like, and the others keep `fixed`.
[[nodiscard]] double square_left(const Eigen::MatrixXd& products, const Indices& free, const Indices& held,
                                 const Eigen::VectorXd& fixed);

}  // namespace fathom::diagnosis
