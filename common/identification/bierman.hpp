// Bierman's measurement update of P = U D U' by one scalar row (1977, ch. V), four numbers at a time.
#pragma once

#include <cstddef>

namespace fathom::identification {

/// Rows of U are walked in packets of four: its row count, and the length of `h` and `gain`, rounded up to packets.
constexpr std::ptrdiff_t padded(std::ptrdiff_t n) { return (n + 3) / 4 * 4; }

/// U is n columns of padded(n) numbers, unit upper triangular, zero elsewhere; D, h and gain have padded(n), h zero
/// behind n; n is at most 32. Updates U and D by a row h of noise `variance` and leaves the gain times its
/// denominator alpha in `gain`; returns 1 / alpha. No allocation; the same bits with and without AVX.
double bierman_update(double* U, double* D, const double* h, std::ptrdiff_t n, double variance, double* gain);

/// Column j of U D U', into padded(n) numbers.
void covariance_column(const double* U, const double* D, std::ptrdiff_t n, std::ptrdiff_t j, double* out);

}  // namespace fathom::identification
