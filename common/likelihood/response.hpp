// What accelerations that are not in a model would do to its innovations, from one filtered pass: the columns of any
// candidate run through the kept gains (score test, Rao 1948; Engle 1984).
#pragma once

#include <functional>
#include <span>

#include "common/likelihood/filter.hpp"

namespace fathom::likelihood {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// axes x columns, to be filled: a view that nobody can give another size.
using ColumnsOut = Eigen::Ref<RowMatrix>;
/// Columns at one block: `acceleration` and, where sensors are altered, `shown`: change of what is measured.
using ColumnSource = std::function<void(std::size_t block, ColumnsOut acceleration, ColumnsOut shown)>;

/// Sums over blocks, weighted as the tails' density weighs them. W: whitened responses.
struct ResponseSums {
  Eigen::MatrixXd with_numbers;  ///< J'W, numbers x columns
  Eigen::MatrixXd gram;          ///< W'W; within the groups alone unless all were asked for
  Eigen::VectorXd gradient;      ///< - W' slope: of the log likelihood
};

/// `groups`: beginnings of groups of columns whose products are wanted; empty: all products.
void respond(const Problem& problem, const RunReference& reference, std::size_t run, std::size_t columns,
             std::span<const std::size_t> groups, const ColumnSource& source, ResponseSums& sums);

/// d log L / d acceleration, axes x blocks: the score of any column is its inner product with it.
[[nodiscard]] Eigen::MatrixXd adjoint(const Problem& problem, const RunReference& reference, std::size_t run);

}  // namespace fathom::likelihood
