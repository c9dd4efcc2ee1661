// What this processor takes at once (docs/decisions/205): functions that say so are compiled for it besides.
#pragma once

#if defined(__x86_64__)
#define FATHOM_AVX2 [[gnu::target("avx2")]]
#endif

namespace fathom::likelihood {

/// Products stay apart from their sums with and without it, so numbers are the same.
[[nodiscard]] inline bool has_avx2() {
#if defined(__x86_64__)
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
#else
  return false;
#endif
}

}  // namespace fathom::likelihood
