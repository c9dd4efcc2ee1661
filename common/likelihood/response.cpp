#include "common/likelihood/response.hpp"

#include "common/likelihood/gathered_rows.hpp"
#include "common/likelihood/response_state.hpp"

namespace fathom::likelihood {
namespace {

template <int N>
struct Gains {
  using Matrix = Eigen::Matrix<double, N, N>;
  Eigen::Map<const Matrix> E, Gamma, K_n, K_d, K_c, L_inverse;
  Gains(const RunReference& reference, std::size_t block)
      : E{at(reference, block, 0)},
        Gamma{at(reference, block, 1)},
        K_n{at(reference, block, 2)},
        K_d{at(reference, block, 3)},
        K_c{at(reference, block, 4)},
        L_inverse{at(reference, block, 5)} {}

 private:
  static const double* at(const RunReference& reference, std::size_t block, std::size_t which) {
    return reference.gains.data() + (block * RunReference::kMatrices + which) * N * N;
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
    const Eigen::Index n = sums_.with_numbers.rows(), m = sums_.gram.rows();
    add_products(of_columns_.columns(0, m), of_numbers_.columns(0, n), of_columns_.count(), sums_.with_numbers.data(),
                 n);
    of_numbers_.clear();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const auto first = static_cast<Eigen::Index>(groups_[g]);
      const auto end = g + 1 < groups_.size() ? static_cast<Eigen::Index>(groups_[g + 1]) : m;
      of_columns_.add_square(first, end - first, sums_.gram.data() + first * m + first, m);
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
  const auto m = static_cast<Eigen::Index>(columns);
  ResponseState<N> state{m};
  ResponseStep<N> step;
  step.mean_force = reference.mean_force;
  step.rho = reference.rho;
  step.rho_colour = reference.rho_colour;
  Products products{groups, reference.numbers, m, sums};
  const auto& blocks = problem.runs[run].blocks();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto at = static_cast<Eigen::Index>(b);
    const Gains<N> gains{reference, b};
    step.E = gains.E;
    step.Gamma = gains.Gamma;
    step.K_nu = gains.K_n;
    step.K_d = gains.K_d;
    step.K_c = gains.K_c;
    step.L_inverse = gains.L_inverse;
    for (int i = 0; i < N; ++i) step.lag[i] = blocks[b].lag[problem.axes[static_cast<std::size_t>(i)]];
    state.added().setZero();
    source(b, state.acceleration(), state.added());
    state.step(step);
    if (!(reference.information.col(at).maxCoeff() > 0.0)) continue;
    const auto W = state.whitened();
    sums.gradient.noalias() -= W.transpose().lazyProduct(reference.slope.col(at));
    for (int i = 0; i < N; ++i) {
      if (reference.information(i, at) > 0.0)
        products.add(reference.J.row(N * at + i), W.row(i), reference.information(i, at));
    }
  }
  products.flush();
}

template <int N>
Eigen::MatrixXd adjoint_with(const Problem& problem, const RunReference& reference, std::size_t run) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const auto& blocks = problem.runs[run].blocks();
  const Vector mean_force = reference.mean_force, rho = reference.rho, rho_colour = reference.rho_colour;
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
    d = mean_force.cwiseProduct(g.col(at)) + rho.cwiseProduct(d);
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
