// What the filter does over a block to a change of accelerations: the inner loop of every fit and of every question to
// features, with as many columns side by side as the processor takes in one operation.
#pragma once

#include <Eigen/Core>

namespace fathom::likelihood {

/// One block for N axes, in the filter's own terms (docs/decisions/126), gains taken as fixed: log det S and K hardly
/// depend on the numbers. Matrices lie row by row.
template <int N>
struct ResponseStep {
  using Matrix = Eigen::Matrix<double, N, N, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<double, N, 1>;
  Matrix E, Gamma;            ///< exp(A dt), and its integral
  Matrix H;                   ///< what sensors show of nu
  Matrix K_nu, K_d, K_c;      ///< gains; zero where nothing is measured
  Matrix L_inverse;           ///< of S = L L'
  Vector mean_force;          ///< mean of d over the block, over d at its beginning
  Vector rho, rho_colour;     ///< what is left of d and c
  Vector lag;                 ///< share of the block by which its mean lies before its end
  bool shows_nu_alone{true};  ///< H is the identity
};

/// N rows of `stride` numbers each; a multiple of kLanes.
struct ResponseColumns {
  const double *acceleration, *added;  ///< pushed in this block; added to what is shown
  double *nu, *d, *c;                  ///< d state / d number, before the block and after it
  double* whitened;                    ///< out: d innovation / d number
  Eigen::Index stride;
};

constexpr Eigen::Index kLanes = 4;

/// The same numbers on every processor of a kind: with AVX2 where it is there, and no product is fused with its sum.
void advance(const ResponseStep<4>& step, const ResponseColumns& columns);
void advance(const ResponseStep<6>& step, const ResponseColumns& columns);

/// Columns of a row-major matrix.
struct RowColumns {
  const double* first;
  Eigen::Index count, stride;
};
/// sum(j, i) += a(., i)' b(., j) over `rows` rows; `sum` lies column by column, `sum_stride` numbers each.
void add_products(const RowColumns& a, const RowColumns& b, Eigen::Index rows, double* sum, Eigen::Index sum_stride);

}  // namespace fathom::likelihood
