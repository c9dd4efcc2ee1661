#include "common/diagnosis/product_sums.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/least_squares.hpp"

namespace fathom::diagnosis {

Indices range(Eigen::Index from, Eigen::Index to) {
  Indices indices;
  for (Eigen::Index i = from; i < to; ++i) indices.push_back(i);
  return indices;
}

identification::LagSums sums_of(const std::vector<Eigen::MatrixXd>& runs) {
  identification::LagSums sums{runs.front().cols()};
  for (const Eigen::MatrixXd& run : runs) sums.add(run);
  return sums;
}

void standardise(std::vector<Eigen::MatrixXd>& runs) {
  if (runs.empty()) return;
  for (Eigen::Index c = 1; c + 1 < runs.front().cols(); ++c) {
    double sum = 0.0, square = 0.0, count = 0.0;
    for (const Eigen::MatrixXd& run : runs) {
      for (Eigen::Index k = 0; k < run.rows(); ++k) {
        if (!std::isfinite(run(k, c))) continue;
        sum += run(k, c);
        square += run(k, c) * run(k, c);
        count += 1.0;
      }
    }
    const double mean = count > 0.0 ? sum / count : 0.0;
    const double spread = count > 0.0 ? std::sqrt(std::max(square / count - mean * mean, 0.0)) : 0.0;
    const double scale = spread > 1e-9 * std::abs(mean) && spread > 0.0 ? 1.0 / spread : 0.0;
    for (Eigen::MatrixXd& run : runs) run.col(c) = (run.col(c).array() - mean) * scale;
  }
}

Eigen::VectorXd taken_up(const Eigen::MatrixXd& products, const Indices& free, const Eigen::VectorXd& right) {
  constexpr double kCollinear = 1e-9;  // relative pivot
  return least_squares(products(free, free), right(free), kCollinear).x;
}

double square_left(const Eigen::MatrixXd& products, const Indices& free, const Indices& held,
                   const Eigen::VectorXd& fixed) {
  const Eigen::Index target = products.cols() - 1;
  Eigen::VectorXd c = Eigen::VectorXd::Zero(products.cols());
  c[target] = 1.0;
  for (std::size_t i = 0; i < held.size(); ++i) c[held[i]] = -fixed[static_cast<Eigen::Index>(i)];
  const Eigen::VectorXd with = products * c;
  return std::max(c.dot(with) - with(free).dot(taken_up(products, free, with)), 0.0);
}

}  // namespace fathom::diagnosis
