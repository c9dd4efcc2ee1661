#include "common/identification/regression/block_bootstrap.hpp"

#include <Eigen/Cholesky>
#include <random>

namespace fathom::identification {

Eigen::MatrixXd block_bootstrap(const LaggedGram& gram, const std::vector<int>& columns, double phi, int repetitions,
                                unsigned seed) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  const auto blocks = static_cast<Eigen::Index>(gram.blocks().size());
  std::vector<Eigen::Index> chosen(columns.begin(), columns.end());
  chosen.push_back(gram.columns() - 1);
  // Lower triangles of the chosen part, one column per block; a resample is a product with how often each was drawn.
  const Eigen::Index entries = (p + 1) * (p + 2) / 2;
  Eigen::MatrixXd parts(entries, blocks);
  for (Eigen::Index k = 0; k < blocks; ++k) {
    const BlockGram& block = gram.blocks()[static_cast<std::size_t>(k)];
    const double left = 1.0 - phi;
    Eigen::Index at = 0;
    for (std::size_t column = 0; column < chosen.size(); ++column) {
      for (std::size_t row = column; row < chosen.size(); ++row) {
        const Eigen::Index i = chosen[row], j = chosen[column];
        double value = phi * block.steps(i, j) + left * left * block.lagged(i, j) +
                       left * (block.last[i] * block.last[j] - block.before[i] * block.before[j]);
        if (block.opens) value += (1.0 - phi * phi) * block.before[i] * block.before[j];
        parts(at++, k) = value;
      }
    }
  }
  std::mt19937 random{seed};
  std::uniform_int_distribution<Eigen::Index> any{0, blocks - 1};
  Eigen::MatrixXd counts = Eigen::MatrixXd::Zero(blocks, repetitions);
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (Eigen::Index k = 0; k < blocks; ++k) counts(any(random), repetition) += 1.0;
  }
  Eigen::MatrixXd sums;
  sums.noalias() = parts * counts;
  Eigen::MatrixXd result(repetitions, p);
  Eigen::MatrixXd G(p + 1, p + 1);
  Eigen::LLT<Eigen::MatrixXd> factor(p);
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    Eigen::Index at = 0;
    for (Eigen::Index j = 0; j <= p; ++j) {
      for (Eigen::Index i = j; i <= p; ++i) G(i, j) = sums(at++, repetition);
    }
    const Eigen::VectorXd scale = G.diagonal().head(p).cwiseSqrt().cwiseInverse();
    factor.compute(scale.asDiagonal() * G.topLeftCorner(p, p).selfadjointView<Eigen::Lower>().toDenseMatrix() *
                   scale.asDiagonal());
    result.row(repetition) =
        scale.cwiseProduct(factor.solve(scale.cwiseProduct(G.row(p).head(p).transpose()))).transpose();
  }
  return result;
}

}  // namespace fathom::identification
