// Bierman's measurement update of P = U D U' by one scalar row (1977, ch. V), four numbers at a time, and the sums that
// go with it. All arrays have padded(n) numbers, zero behind n; n is at most 32. Nothing here allocates, and the bits
// are the same with and without AVX.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fathom::identification {

/// Rows of U are walked in packets of four: its row count, and the length of all vectors, rounded up to packets.
constexpr std::ptrdiff_t padded(std::ptrdiff_t n) { return (n + 3) / 4 * 4; }

/// What a scalar row changes.
struct Recursion {
  double* U;            ///< n columns of padded(n), unit upper triangular, zero elsewhere
  double* D;            ///< diagonal
  double* x;            ///< estimate
  double* score;        ///< grows by h * residual / variance
  double* information;  ///< grows by h^2 / variance
  const double* free;   ///< 1 where x may move, 0 where it is held
  std::ptrdiff_t n;
};

struct Taken {
  double residual;   ///< innovation times sqrt(variance / alpha): it has the row's variance when the model is right
  double per_alpha;  ///< alpha = h' P h + variance
};

/// Takes in h . x = y of noise `variance`; what h has behind n does not count. Leaves P h in `gain`.
Taken take_row(const Recursion& to, const double* h, double y, double variance, double* gain);

/// Powers of a step's scores, and products of their sums over some steps, `keep` of the old ones left.
struct ScoreSums {
  double *squares, *fourth;
  double *together, *apart;           ///< a sum's square; its product with the sum of just as many steps before
  const double* sum;                  ///< as the step before left it
  double *oldest_score, *oldest_sum;  ///< which leave; the step's own take their places
  std::ptrdiff_t n;
};
void add_scores(const ScoreSums& to, const double* score, double keep);

/// Bit i: x_i breaks sign_i, which is 0 where x_i is free.
std::uint32_t violated(const double* x, const double* sign, std::ptrdiff_t n);

/// x += factor v
void add_multiple(double* x, double factor, const double* v, std::ptrdiff_t n);

/// Column j of U D U'.
void covariance_column(const double* U, const double* D, std::ptrdiff_t n, std::ptrdiff_t j, double* out);

}  // namespace fathom::identification
