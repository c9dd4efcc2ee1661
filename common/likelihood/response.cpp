#include "common/likelihood/response.hpp"

#include "common/likelihood/filter_pass.hpp"

namespace fathom::likelihood {
namespace {

template <int N>
struct Gains {
  using Matrix = Eigen::Matrix<double, N, N>;
  Eigen::Map<const Matrix> E, G, Gamma, K_n, K_d, K_c, L_inverse;
  Gains(const RunReference& reference, std::size_t block)
      : E{at(reference, block, 0)},
        G{at(reference, block, 1)},
        Gamma{at(reference, block, 2)},
        K_n{at(reference, block, 3)},
        K_d{at(reference, block, 4)},
        K_c{at(reference, block, 5)},
        L_inverse{at(reference, block, 6)} {}

 private:
  static const double* at(const RunReference& reference, std::size_t block, std::size_t which) {
    return reference.gains.data() + (block * 7 + which) * N * N;
  }
};

template <int N>
void respond_with(const Problem& problem, const RunReference& reference, std::size_t run, std::size_t columns,
                  std::span<const std::size_t> groups, const ColumnSource& source, ResponseSums& sums) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const auto m = static_cast<Eigen::Index>(columns);
  Response<N> response{m};
  RowMatrix acceleration = RowMatrix::Zero(N, m), shown = RowMatrix::Zero(N, m);
  typename Response<N>::Wide pushed = Response<N>::Wide::Zero(N, m), W = pushed;
  const Vector rho = reference.rho, rho_colour = reference.rho_colour;
  const Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Identity();
  const auto& blocks = problem.runs[run].blocks();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto at = static_cast<Eigen::Index>(b);
    const Gains<N> gains{reference, b};
    shown.setZero();
    source(b, acceleration, shown);
    pushed = acceleration;
    response.predict(gains.E, gains.G, gains.Gamma, rho, rho_colour, H, pushed);
    Vector lag;
    for (int i = 0; i < N; ++i) lag[i] = blocks[b].lag[problem.axes[static_cast<std::size_t>(i)]];
    (void)response.shown(lag, H);
    response.shown() += shown;
    if (reference.information.col(at).maxCoeff() > 0.0) {
      times<N, false>((-gains.L_inverse).eval(), response.shown(), W);
      sums.gradient.noalias() -= W.transpose().lazyProduct(reference.slope.col(at));
      for (int i = 0; i < N; ++i) {
        const double weight = reference.information(i, at);
        if (weight == 0.0) continue;
        const auto row = W.row(i);
        for (Eigen::Index j = 0; j < reference.numbers; ++j)
          sums.with_numbers.row(j) += (weight * reference.J(N * at + i, j)) * row;
        if (groups.empty()) {
          sums.gram.selfadjointView<Eigen::Lower>().rankUpdate(row.transpose(), weight);
          continue;
        }
        for (std::size_t g = 0; g < groups.size(); ++g) {
          const auto first = static_cast<Eigen::Index>(groups[g]);
          const auto end = g + 1 < groups.size() ? static_cast<Eigen::Index>(groups[g + 1]) : m;
          for (Eigen::Index c = first; c < end; ++c)
            for (Eigen::Index d = first; d <= c; ++d) sums.gram(c, d) += weight * row[c] * row[d];
        }
      }
    }
    response.update(gains.K_n, gains.K_d, gains.K_c);
  }
}

template <int N>
Eigen::MatrixXd adjoint_with(const Problem& problem, const RunReference& reference, std::size_t run) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const auto& blocks = problem.runs[run].blocks();
  const Vector rho = reference.rho, rho_colour = reference.rho_colour;
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(N, static_cast<Eigen::Index>(blocks.size()));
  // Adjoints of nu, d, c after the block's update, and of nu + c before the next one's prediction.
  Vector nu = Vector::Zero(), d = nu, c = nu;
  for (std::size_t b = blocks.size(); b-- > 0;) {
    const auto at = static_cast<Eigen::Index>(b);
    const Gains<N> gains{reference, b};
    Vector lag;
    for (int i = 0; i < N; ++i) lag[i] = blocks[b].lag[problem.axes[static_cast<std::size_t>(i)]];
    const Vector late = Vector::Ones() - lag;
    // shown = late (nu- + c-) + lag (nu + c before); x+ = x- - K shown; log L slope with shown: L^-T slope.
    const Vector of_shown = gains.L_inverse.transpose() * reference.slope.col(at) - gains.K_n.transpose() * nu -
                            gains.K_d.transpose() * d - gains.K_c.transpose() * c;
    const Vector nu_minus = nu + late.cwiseProduct(of_shown), c_minus = c + late.cwiseProduct(of_shown);
    g.col(at) = gains.Gamma.transpose() * nu_minus;
    const Vector before = lag.cwiseProduct(of_shown);
    nu = gains.E.transpose() * nu_minus + before;
    d = gains.G.transpose() * nu_minus + rho.cwiseProduct(d);
    c = rho_colour.cwiseProduct(c_minus) + before;
  }
  return g;
}

}  // namespace

void respond(const Problem& problem, const RunReference& reference, std::size_t run, std::size_t columns,
             std::span<const std::size_t> groups, const ColumnSource& source, ResponseSums& sums) {
  const auto m = static_cast<Eigen::Index>(columns);
  if (sums.gradient.size() != m) {
    sums.with_numbers.setZero(reference.numbers, m);
    sums.gram.setZero(m, m);
    sums.gradient.setZero(m);
  }
  if (reference.axes == 4) {
    respond_with<4>(problem, reference, run, columns, groups, source, sums);
  } else {
    respond_with<6>(problem, reference, run, columns, groups, source, sums);
  }
}

Eigen::MatrixXd adjoint(const Problem& problem, const RunReference& reference, std::size_t run) {
  return reference.axes == 4 ? adjoint_with<4>(problem, reference, run) : adjoint_with<6>(problem, reference, run);
}

}  // namespace fathom::likelihood
