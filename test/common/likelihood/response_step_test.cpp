#include "common/likelihood/response_step.hpp"

#include <doctest/doctest.h>

#include "common/likelihood/gathered_rows.hpp"
#include "common/likelihood/response_state.hpp"

using namespace fathom::likelihood;

namespace {

template <int N>
ResponseStep<N> some_step(bool plain) {
  using Matrix = typename ResponseStep<N>::Matrix;
  const auto about = [](double diagonal) { return (diagonal * Matrix::Identity() + 0.05 * Matrix::Random()).eval(); };
  ResponseStep<N> step;
  step.E = about(0.9);
  step.Gamma = about(0.1);
  step.H = plain ? Matrix::Identity() : about(1.0);
  step.K_nu = about(0.3);
  step.K_d = about(0.2);
  step.K_c = about(0.1);
  step.L_inverse = about(3.0);
  step.mean_force.setRandom();
  step.rho.setConstant(0.8);
  step.rho_colour.setConstant(0.6);
  step.lag.setConstant(0.4);
  step.shows_nu_alone = plain;
  return step;
}

/// The equations of docs/decisions/126 as they stand there, against the loop over lanes, for so many columns.
template <int N>
double largest_difference(Eigen::Index columns, bool plain) {
  ResponseState<N> state{columns};
  Eigen::MatrixXd nu = Eigen::MatrixXd::Zero(N, columns), d = nu, c = nu;
  double largest = 0.0;
  for (int block = 0; block < 20; ++block) {
    const ResponseStep<N> step = some_step<N>(plain);
    const Eigen::MatrixXd acceleration = Eigen::MatrixXd::Random(N, columns),
                          added = Eigen::MatrixXd::Random(N, columns);
    state.acceleration().leftCols(columns) = acceleration;
    state.added().leftCols(columns) = added;
    state.step(step);

    const Eigen::MatrixXd before = step.H * nu + c;
    nu = (step.E * nu + step.Gamma * (acceleration + step.mean_force.asDiagonal() * d)).eval();
    d = (step.rho.asDiagonal() * d).eval();
    c = (step.rho_colour.asDiagonal() * c).eval();
    const Eigen::MatrixXd shown =
        (1.0 - step.lag.array()).matrix().asDiagonal() * (step.H * nu + c) + step.lag.asDiagonal() * before + added;
    const Eigen::MatrixXd whitened = -step.L_inverse * shown;
    nu -= step.K_nu * shown;
    d -= step.K_d * shown;
    c -= step.K_c * shown;
    largest = std::max(
        {largest, (state.whitened() - whitened).cwiseAbs().maxCoeff(), (state.nu() - nu).cwiseAbs().maxCoeff()});
  }
  return largest;
}

}  // namespace

TEST_CASE("a step of many columns at once is the filter's equations, for any number of columns") {
  for (const bool plain : {true, false}) {
    for (const Eigen::Index columns : {1, 3, 4, 5, 8, 13}) {
      CAPTURE(columns);
      CHECK(largest_difference<4>(columns, plain) < 1e-12);  // rounding of numbers near one
      CHECK(largest_difference<6>(columns, plain) < 1e-12);
    }
  }
}

TEST_CASE("sums of products of gathered rows are those of matrices") {
  for (const Eigen::Index columns : {1, 4, 7, 8, 17, 30}) {
    GatheredRows gathered{columns};
    Eigen::MatrixXd weighted(GatheredRows::kMost, columns);
    for (Eigen::Index r = 0; r < GatheredRows::kMost; ++r) {
      const Eigen::RowVectorXd row = Eigen::RowVectorXd::Random(columns);
      gathered.add(row, 4.0);
      weighted.row(r) = 2.0 * row;
    }
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(columns, columns);
    add_products(gathered.columns(0, columns), gathered.columns(0, columns), gathered.count(), products.data(),
                 columns);
    const Eigen::MatrixXd right = weighted.transpose() * weighted;
    CHECK((products - right).cwiseAbs().maxCoeff() < 1e-11);
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(columns, columns);
    gathered.add_to(lower);
    CHECK((lower - right).triangularView<Eigen::Lower>().toDenseMatrix().cwiseAbs().maxCoeff() < 1e-11);
    CHECK(gathered.empty());
  }
}
