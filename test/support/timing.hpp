// What the sanitizers change: code is several times slower, so limits on time do not hold, and few seeds must do.
#pragma once

#include <string>

namespace fathom::test {

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kTimed = false;
#else
inline constexpr bool kTimed = true;
#endif

/// How many seeds a statement that must hold for each of them is tried on: the full number in the ordinary build.
constexpr unsigned seeds(unsigned full) { return kTimed || full < 6 ? full : full / 6; }

/// So many times longer processes may take, as ctest gives them (cmake/test_cases.cmake).
inline constexpr int kPatience = kTimed ? 1 : 6;
/// "timeout 60 " in the ordinary build: ends what hangs.
inline std::string limit(int seconds) { return "timeout " + std::to_string(seconds * kPatience) + " "; }

}  // namespace fathom::test
