// Limits on time are for the ordinary build: the sanitizers make code several times slower.
#pragma once

namespace fathom::test {

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kTimed = false;
#else
inline constexpr bool kTimed = true;
#endif

}  // namespace fathom::test
