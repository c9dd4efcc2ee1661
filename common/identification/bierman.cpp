// Compiled twice where the processor's AVX can be asked for at run time: vectors of four then are one register. Without
// fused multiply-add, which would round otherwise, so a log replays to the same bits everywhere.
#include "common/identification/bierman.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
using Lanes = std::int64_t __attribute__((vector_size(32)));
constexpr std::ptrdiff_t kMost = 32;

FATHOM_INLINE void load(Packet& p, const double* from) { std::memcpy(&p, from, sizeof(p)); }
FATHOM_INLINE void store(double* to, const Packet& p) { std::memcpy(to, &p, sizeof(p)); }

// The last packet of a vector whose numbers behind n are anybody's.
FATHOM_INLINE void load_last(Packet& p, const double* from, std::ptrdiff_t n) {
  static constexpr std::array<std::int64_t, 8> kMask{-1, -1, -1, -1, 0, 0, 0, 0};
  Lanes lanes, mask;
  std::memcpy(&lanes, from + (n - 1) / 4 * 4, sizeof(lanes));
  std::memcpy(&mask, kMask.data() + 3 - (n - 1) % 4, sizeof(mask));
  lanes &= mask;
  std::memcpy(&p, &lanes, sizeof(p));
}

FATHOM_INLINE double sum_of(const Packet& p) { return (p[0] + p[2]) + (p[1] + p[3]); }

// f = U' h, four columns at a time; what lies below the diagonal is zero, so whole packets are walked.
template <int Packets>
FATHOM_INLINE void project(const double* U, const Packet* H, std::ptrdiff_t n, Packet* F) {
  constexpr std::ptrdiff_t kStride = 4 * Packets;
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
    F[b] = even + odd;
  }
}

// Bierman's inner loop over columns with all packets of the gain in registers. Nothing special is needed at the
// diagonal: the gain of parameter i is zero until column i, whose unit entry starts it.
template <int Packets>
FATHOM_INLINE Taken take(const Recursion& all, const double* h, double y, double variance, double* gain) {
  constexpr std::ptrdiff_t kStride = 4 * Packets;
  const Recursion to = all;  // what is stored through pointers cannot change it
  const std::ptrdiff_t n = to.n;
  alignas(32) std::array<double, kMost> g, lambda;
  Packet H[Packets];  // NOLINT(modernize-avoid-c-arrays): of vectors, whose attributes std::array would drop
  Packet F[Packets];  // NOLINT(modernize-avoid-c-arrays)
  FATHOM_UNROLLED
  for (int b = 0; b < Packets - 1; ++b) load(H[b], h + 4 * b);
  load_last(H[Packets - 1], h, n);
  project<Packets>(to.U, H, n, F);
  Packet foretold{};
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) {
    Packet x;
    load(x, to.x + 4 * b);
    foretold += H[b] * x;
  }
  const double innovation = y - sum_of(foretold);
  // The denominators are running sums, packet by packet: one addition behind another for each four columns.
  Packet last = {0.0, 0.0, 0.0, variance}, per_last = 1.0 / (last + Packet{1.0, 1.0, 1.0, 0.0});
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) {
    Packet d;
    load(d, to.D + 4 * b);
    const Packet G = d * F[b], zero{};
    Packet alpha = F[b] * G;
    alpha += __builtin_shufflevector(zero, alpha, 0, 4, 5, 6);
    alpha += __builtin_shufflevector(zero, alpha, 0, 1, 4, 5);
    alpha += __builtin_shufflevector(last, last, 3, 3, 3, 3);
    const Packet per_alpha = 1.0 / alpha;
    store(g.data() + 4 * b, G);
    store(lambda.data() + 4 * b, -F[b] * __builtin_shufflevector(per_last, per_alpha, 3, 4, 5, 6));
    store(to.D + 4 * b, d * (__builtin_shufflevector(last, alpha, 3, 4, 5, 6) * per_alpha));
    last = alpha;
    per_last = per_alpha;
  }
  Packet K[Packets];  // NOLINT(modernize-avoid-c-arrays)
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) K[b] = Packet{};
  FATHOM_UNROLLED
  for (int B = 0; B < Packets; ++B) {
    FATHOM_UNROLLED
    for (int c = 0; c < 4; ++c) {
      const std::ptrdiff_t j = 4 * B + c;
      if (B == Packets - 1 && j >= n) break;
      const double shrink = lambda[static_cast<std::size_t>(j)], add = g[static_cast<std::size_t>(j)];
      double* column = to.U + j * kStride;
      FATHOM_UNROLLED
      for (int b = 0; b <= B; ++b) {
        Packet beta;
        load(beta, column + 4 * b);
        store(column + 4 * b, beta + shrink * K[b]);
        K[b] += add * beta;
      }
    }
  }
  const double one_by_alpha = per_last[(n - 1) % 4];
  const double residual = innovation * std::sqrt(variance * one_by_alpha);
  const double step = innovation * one_by_alpha, per_variance = 1.0 / variance, weight = residual * per_variance;
  FATHOM_UNROLLED
  for (int b = 0; b < Packets; ++b) {
    Packet x, free, score, information;
    load(x, to.x + 4 * b);
    load(free, to.free + 4 * b);
    load(score, to.score + 4 * b);
    load(information, to.information + 4 * b);
    store(gain + 4 * b, K[b]);
    store(to.x + 4 * b, x + step * K[b] * free);
    store(to.score + 4 * b, score + weight * H[b]);
    store(to.information + 4 * b, information + per_variance * (H[b] * H[b]));
  }
  return {residual, one_by_alpha};
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
Taken take_row(const Recursion& to, const double* h, double y, double variance, double* gain) {
  switch (padded(to.n) / 4) {
    case 1:
      return take<1>(to, h, y, variance, gain);
    case 2:
      return take<2>(to, h, y, variance, gain);
    case 3:
      return take<3>(to, h, y, variance, gain);
    case 4:
      return take<4>(to, h, y, variance, gain);
    case 5:
      return take<5>(to, h, y, variance, gain);
    case 6:
      return take<6>(to, h, y, variance, gain);
    case 7:
      return take<7>(to, h, y, variance, gain);
    default:
      return take<8>(to, h, y, variance, gain);
  }
}

FATHOM_ALSO_WITH_AVX
void add_scores(const ScoreSums& to, const double* score, double keep) {
  for (std::ptrdiff_t i = 0; i < to.n; i += 4) {
    Packet s, sum, oldest_score, oldest_sum, squares, fourth, together, apart;
    load(s, score + i);
    load(sum, to.sum + i);
    load(oldest_score, to.oldest_score + i);
    load(oldest_sum, to.oldest_sum + i);
    load(squares, to.squares + i);
    load(fourth, to.fourth + i);
    load(together, to.together + i);
    load(apart, to.apart + i);
    const Packet square = s * s;
    sum += s - oldest_score;
    store(to.squares + i, keep * squares + square);
    store(to.fourth + i, keep * fourth + square * square);
    store(to.together + i, keep * together + sum * sum);
    store(to.apart + i, keep * apart + sum * oldest_sum);
    store(to.oldest_score + i, s);
    store(to.oldest_sum + i, sum);
  }
}

FATHOM_ALSO_WITH_AVX
std::uint32_t violated(const double* x, const double* sign, std::ptrdiff_t n) {
  Lanes bits{}, bit{1, 2, 4, 8};
  for (std::ptrdiff_t i = 0; i < n; i += 4, bit <<= 4) {
    Packet value, wanted;
    load(value, x + i);
    load(wanted, sign + i);
    bits |= (value * wanted < Packet{}) & bit;
  }
  return static_cast<std::uint32_t>((bits[0] | bits[1]) | (bits[2] | bits[3]));
}

FATHOM_ALSO_WITH_AVX
void add_multiple(double* x, double factor, const double* v, std::ptrdiff_t n) {
  for (std::ptrdiff_t i = 0; i < n; i += 4) {
    Packet to, from;
    load(to, x + i);
    load(from, v + i);
    store(x + i, to + factor * from);
  }
}

}  // namespace fathom::identification
