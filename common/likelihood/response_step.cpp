#include "common/likelihood/response_step.hpp"

#include <cstring>

#include "common/likelihood/processor.hpp"

// Loops over axes must unroll, or each product is fetched anew.
#if defined(__clang__)
#define FATHOM_UNROLL _Pragma("unroll")
#else
#define FATHOM_UNROLL _Pragma("GCC unroll 8")
#endif

namespace fathom::likelihood {
namespace {

/// `kWidth` columns in one operation.
template <int kWidth>
struct Lanes {
  typedef double Type __attribute__((vector_size(sizeof(double) * kWidth)));
};

template <int N, int kWidth>
[[gnu::always_inline]] inline void advance_lanes(const ResponseStep<N>& step, const ResponseColumns& x) {
  using Lane = typename Lanes<kWidth>::Type;
  const double *E = step.E.data(), *Gamma = step.Gamma.data(), *H = step.H.data(), *L = step.L_inverse.data();
  const double *K_nu = step.K_nu.data(), *K_d = step.K_d.data(), *K_c = step.K_c.data();
  for (Eigen::Index at = 0; at < x.stride; at += kWidth) {
    Lane nu[N], d[N], c[N], push[N], next[N], before[N], shown[N];
    FATHOM_UNROLL for (int i = 0; i < N; ++i) {
      Lane acceleration;
      std::memcpy(&nu[i], x.nu + i * x.stride + at, sizeof(Lane));
      std::memcpy(&d[i], x.d + i * x.stride + at, sizeof(Lane));
      std::memcpy(&c[i], x.c + i * x.stride + at, sizeof(Lane));
      std::memcpy(&acceleration, x.acceleration + i * x.stride + at, sizeof(Lane));
      push[i] = acceleration + step.mean_force[i] * d[i];
    }
    FATHOM_UNROLL for (int i = 0; i < N; ++i) {
      Lane sum = E[i * N] * nu[0], seen = c[i];
      FATHOM_UNROLL for (int k = 1; k < N; ++k) sum += E[i * N + k] * nu[k];
      FATHOM_UNROLL for (int k = 0; k < N; ++k) sum += Gamma[i * N + k] * push[k];
      if (step.shows_nu_alone) {
        seen += nu[i];
      } else {
        FATHOM_UNROLL for (int k = 0; k < N; ++k) seen += H[i * N + k] * nu[k];
      }
      next[i] = sum;
      before[i] = seen;
    }
    FATHOM_UNROLL for (int i = 0; i < N; ++i) {
      Lane added;
      std::memcpy(&added, x.added + i * x.stride + at, sizeof(Lane));
      d[i] *= step.rho[i];
      c[i] *= step.rho_colour[i];
      Lane seen = c[i];
      if (step.shows_nu_alone) {
        seen += next[i];
      } else {
        FATHOM_UNROLL for (int k = 0; k < N; ++k) seen += H[i * N + k] * next[k];
      }
      shown[i] = (1.0 - step.lag[i]) * seen + step.lag[i] * before[i] + added;
    }
    FATHOM_UNROLL for (int i = 0; i < N; ++i) {
      Lane whitened = -L[i * N] * shown[0];
      FATHOM_UNROLL for (int k = 1; k < N; ++k) whitened -= L[i * N + k] * shown[k];
      FATHOM_UNROLL for (int k = 0; k < N; ++k) next[i] -= K_nu[i * N + k] * shown[k];
      FATHOM_UNROLL for (int k = 0; k < N; ++k) d[i] -= K_d[i * N + k] * shown[k];
      FATHOM_UNROLL for (int k = 0; k < N; ++k) c[i] -= K_c[i * N + k] * shown[k];
      std::memcpy(x.whitened + i * x.stride + at, &whitened, sizeof(Lane));
      std::memcpy(x.nu + i * x.stride + at, &next[i], sizeof(Lane));
      std::memcpy(x.d + i * x.stride + at, &d[i], sizeof(Lane));
      std::memcpy(x.c + i * x.stride + at, &c[i], sizeof(Lane));
    }
  }
}

/// kTile columns of a with one lane of b, the sums kept in registers over all rows.
template <int kWidth>
[[gnu::always_inline]] inline void add_product_lanes(const RowColumns& a, const RowColumns& b, Eigen::Index rows,
                                                     double* sum, Eigen::Index sum_stride) {
  using Lane = typename Lanes<kWidth>::Type;
  constexpr int kTile = 4;
  for (Eigen::Index i = 0; i < a.count; i += kTile) {
    const Eigen::Index tile = a.count - i < kTile ? a.count - i : kTile;
    for (Eigen::Index j = 0; j < b.count; j += kWidth) {
      const Eigen::Index width = b.count - j < kWidth ? b.count - j : kWidth;
      if (tile == kTile && width == kWidth) {
        Lane of[kTile] = {};
        for (Eigen::Index r = 0; r < rows; ++r) {
          Lane other;
          std::memcpy(&other, b.first + r * b.stride + j, sizeof(Lane));
          const double* one = a.first + r * a.stride + i;
          FATHOM_UNROLL for (int k = 0; k < kTile; ++k) of[k] += one[k] * other;
        }
        for (int k = 0; k < kTile; ++k) {
          for (int l = 0; l < kWidth; ++l) sum[(i + k) * sum_stride + j + l] += of[k][l];
        }
        continue;
      }
      for (Eigen::Index k = 0; k < tile; ++k) {
        for (Eigen::Index l = 0; l < width; ++l) {
          double of = 0.0;
          for (Eigen::Index r = 0; r < rows; ++r) of += a.first[r * a.stride + i + k] * b.first[r * b.stride + j + l];
          sum[(i + k) * sum_stride + j + l] += of;
        }
      }
    }
  }
}

constexpr int kEverywhere = 2;  // numbers at once: every x86-64 and arm64 has that

#if defined(FATHOM_AVX2)
FATHOM_AVX2 void advance_avx2(const ResponseStep<4>& step, const ResponseColumns& columns) {
  advance_lanes<4, kLanes>(step, columns);
}
FATHOM_AVX2 void advance_avx2(const ResponseStep<6>& step, const ResponseColumns& columns) {
  advance_lanes<6, kLanes>(step, columns);
}
FATHOM_AVX2 void add_products_avx2(const RowColumns& a, const RowColumns& b, Eigen::Index rows, double* sum,
                                   Eigen::Index sum_stride) {
  add_product_lanes<kLanes>(a, b, rows, sum, sum_stride);
}
#endif

}  // namespace

void advance(const ResponseStep<4>& step, const ResponseColumns& columns) {
#if defined(FATHOM_AVX2)
  if (has_avx2()) return advance_avx2(step, columns);
#endif
  advance_lanes<4, kEverywhere>(step, columns);
}

void advance(const ResponseStep<6>& step, const ResponseColumns& columns) {
#if defined(FATHOM_AVX2)
  if (has_avx2()) return advance_avx2(step, columns);
#endif
  advance_lanes<6, kEverywhere>(step, columns);
}

void add_products(const RowColumns& a, const RowColumns& b, Eigen::Index rows, double* sum, Eigen::Index sum_stride) {
#if defined(FATHOM_AVX2)
  if (has_avx2()) return add_products_avx2(a, b, rows, sum, sum_stride);
#endif
  add_product_lanes<kEverywhere>(a, b, rows, sum, sum_stride);
}

}  // namespace fathom::likelihood
