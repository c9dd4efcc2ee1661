#include "common/likelihood/response.hpp"

#include "common/likelihood/gathered_rows.hpp"
#include "common/likelihood/sensitivity.hpp"

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

/// Sums over gathered rows of responses and of the numbers' derivatives.
class Products {
 public:
  Products(std::span<const std::size_t> groups, Eigen::Index numbers, Eigen::Index columns, ResponseSums& sums)
      : groups_{groups}, of_numbers_{numbers}, of_columns_{columns}, sums_{sums} {}

  template <typename Numbers, typename Columns>
  void add(const Numbers& J, const Columns& W, double weight) {
    of_numbers_.add(J, weight);
    of_columns_.add(W, weight);
    if (of_columns_.full()) flush();
  }
  void flush() {
    if (of_columns_.empty()) return;
    const auto rows = of_columns_.rows();
    sums_.with_numbers.noalias() += of_numbers_.rows().transpose() * rows;
    of_numbers_.clear();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const auto first = static_cast<Eigen::Index>(groups_[g]);
      const auto end = g + 1 < groups_.size() ? static_cast<Eigen::Index>(groups_[g + 1]) : rows.cols();
      const auto group = rows.middleCols(first, end - first);
      sums_.gram.block(first, first, end - first, end - first).noalias() += group.transpose() * group;
    }
    if (groups_.empty()) {
      of_columns_.add_to(sums_.gram);
    } else {
      of_columns_.clear();
    }
  }

 private:
  std::span<const std::size_t> groups_;
  GatheredRows of_numbers_, of_columns_;
  ResponseSums& sums_;
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
  Products products{groups, reference.numbers, m, sums};
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
    response.show(lag, H) += shown;
    if (reference.information.col(at).maxCoeff() > 0.0) {
      times<N, false>((-gains.L_inverse).eval(), response.shown(), W);
      sums.gradient.noalias() -= W.transpose().lazyProduct(reference.slope.col(at));
      for (int i = 0; i < N; ++i) {
        if (reference.information(i, at) > 0.0)
          products.add(reference.J.row(N * at + i), W.row(i), reference.information(i, at));
      }
    }
    response.update(gains.K_n, gains.K_d, gains.K_c);
  }
  products.flush();
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
