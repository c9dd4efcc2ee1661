// Compiled twice where the processor's AVX can be asked for at run time: vectors of four then are one register. Without
// fused multiply-add, which would round otherwise, so a log replays to the same bits everywhere.
#include "common/identification/bierman.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
#define FATHOM_ALSO_WITH_AVX __attribute__((target_clones("avx", "default")))
#else
#define FATHOM_ALSO_WITH_AVX
#endif
#if defined(__clang__)
#define FATHOM_UNROLLED _Pragma("unroll")
#else
#define FATHOM_UNROLLED _Pragma("GCC unroll 8")
#endif
#define FATHOM_INLINE __attribute__((always_inline)) inline

namespace fathom::identification {
namespace {

using Packet = double __attribute__((vector_size(32)));
constexpr std::ptrdiff_t kMost = 32;

FATHOM_INLINE void load(Packet& p, const double* from) { std::memcpy(&p, from, sizeof(p)); }
FATHOM_INLINE void store(double* to, const Packet& p) { std::memcpy(to, &p, sizeof(p)); }

// f = U' h, four columns at a time; what lies below the diagonal is zero, so whole packets are walked.
template <int Packets>
FATHOM_INLINE void project(const double* U, const double* h, std::ptrdiff_t n, double* f) {
  constexpr std::ptrdiff_t kStride = 4 * Packets;
  Packet H[Packets];  // NOLINT(modernize-avoid-c-arrays): of vectors, whose attributes std::array would drop
  FATHOM_UNROLLED
  for (int i = 0; i < Packets; ++i) load(H[i], h + 4 * i);
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) {
    Packet sum[4];  // NOLINT(modernize-avoid-c-arrays)
    FATHOM_UNROLLED
    for (int c = 0; c < 4; ++c) {
      const double* column = U + std::min<std::ptrdiff_t>(4 * b + c, n - 1) * kStride;
      Packet first;
      load(first, column);
      sum[c] = first * H[0];
      FATHOM_UNROLLED
      for (int i = 1; i <= b; ++i) {
        Packet next;
        load(next, column + 4 * i);
        sum[c] += next * H[i];
      }
    }
    const Packet even01 = __builtin_shufflevector(sum[0], sum[1], 0, 4, 2, 6);
    const Packet odd01 = __builtin_shufflevector(sum[0], sum[1], 1, 5, 3, 7);
    const Packet even23 = __builtin_shufflevector(sum[2], sum[3], 0, 4, 2, 6);
    const Packet odd23 = __builtin_shufflevector(sum[2], sum[3], 1, 5, 3, 7);
    const Packet even =
        __builtin_shufflevector(even01, even23, 0, 1, 4, 5) + __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
    const Packet odd =
        __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5) + __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
    store(f + 4 * b, even + odd);
  }
}

// Bierman's inner loop over columns with all packets of the gain in registers. Nothing special is needed at the
// diagonal: the gain of parameter i is zero until column i, whose unit entry starts it.
template <int Packets>
FATHOM_INLINE double update(double* U, double* D, const double* h, std::ptrdiff_t n, double variance, double* gain) {
  constexpr std::ptrdiff_t kStride = 4 * Packets;
  alignas(32) std::array<double, kMost> f, g, lambda;
  project<Packets>(U, h, n, f.data());
  // The denominators are running sums, packet by packet: one addition behind another for each four columns.
  Packet last = {0.0, 0.0, 0.0, variance}, per_last = 1.0 / (last + Packet{1.0, 1.0, 1.0, 0.0});
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) {
    Packet F, d;
    load(F, f.data() + 4 * b);
    load(d, D + 4 * b);
    const Packet G = d * F, zero{};
    Packet alpha = F * G;
    alpha += __builtin_shufflevector(zero, alpha, 0, 4, 5, 6);
    alpha += __builtin_shufflevector(zero, alpha, 0, 1, 4, 5);
    alpha += __builtin_shufflevector(last, last, 3, 3, 3, 3);
    const Packet per_alpha = 1.0 / alpha;
    store(g.data() + 4 * b, G);
    store(lambda.data() + 4 * b, -F * __builtin_shufflevector(per_last, per_alpha, 3, 4, 5, 6));
    store(D + 4 * b, d * (__builtin_shufflevector(last, alpha, 3, 4, 5, 6) * per_alpha));
    last = alpha;
    per_last = per_alpha;
  }
  Packet K[Packets];  // NOLINT(modernize-avoid-c-arrays)
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) K[b] = Packet{};
  FATHOM_UNROLLED
  for (int B = 0; B < Packets; ++B) {
    const std::ptrdiff_t end = std::min<std::ptrdiff_t>(4 * B + 4, n);
    for (std::ptrdiff_t j = 4 * B; j < end; ++j) {
      const double shrink = lambda[static_cast<std::size_t>(j)], add = g[static_cast<std::size_t>(j)];
      double* column = U + j * kStride;
      FATHOM_UNROLLED
      for (int b = 0; b <= B; ++b) {
        Packet beta;
        load(beta, column + 4 * b);
        store(column + 4 * b, beta + shrink * K[b]);
        K[b] += add * beta;
      }
    }
  }
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) store(gain + 4 * b, K[b]);
  return per_last[(n - 1) % 4];
}

template <int Packets>
FATHOM_INLINE void column(const double* U, const double* D, std::ptrdiff_t n, std::ptrdiff_t j, double* out) {
  constexpr std::ptrdiff_t kStride = 4 * Packets;
  Packet sum[Packets];  // NOLINT(modernize-avoid-c-arrays)
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) sum[b] = Packet{};
  for (std::ptrdiff_t k = j; k < n; ++k) {
    const double* from = U + k * kStride;
    const double share = D[k] * from[j];
    FATHOM_UNROLLED
    for (int b = 0; b < Packets; ++b) {
      Packet next;
      load(next, from + 4 * b);
      sum[b] += share * next;
    }
  }
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) store(out + 4 * b, sum[b]);
}

}  // namespace

FATHOM_ALSO_WITH_AVX
void covariance_column(const double* U, const double* D, std::ptrdiff_t n, std::ptrdiff_t j, double* out) {
  switch (padded(n) / 4) {
    case 1:
      return column<1>(U, D, n, j, out);
    case 2:
      return column<2>(U, D, n, j, out);
    case 3:
      return column<3>(U, D, n, j, out);
    case 4:
      return column<4>(U, D, n, j, out);
    case 5:
      return column<5>(U, D, n, j, out);
    case 6:
      return column<6>(U, D, n, j, out);
    case 7:
      return column<7>(U, D, n, j, out);
    default:
      return column<8>(U, D, n, j, out);
  }
}

FATHOM_ALSO_WITH_AVX
double bierman_update(double* U, double* D, const double* h, std::ptrdiff_t n, double variance, double* gain) {
  switch (padded(n) / 4) {
    case 1:
      return update<1>(U, D, h, n, variance, gain);
    case 2:
      return update<2>(U, D, h, n, variance, gain);
    case 3:
      return update<3>(U, D, h, n, variance, gain);
    case 4:
      return update<4>(U, D, h, n, variance, gain);
    case 5:
      return update<5>(U, D, h, n, variance, gain);
    case 6:
      return update<6>(U, D, h, n, variance, gain);
    case 7:
      return update<7>(U, D, h, n, variance, gain);
    default:
      return update<8>(U, D, h, n, variance, gain);
  }
}

}  // namespace fathom::identification
