#include "common/launch/backoff.hpp"

#include <algorithm>

namespace fathom::launch {

void Backoff::started(double now) {
  const double since = now - last_;
  last_ = now;
  if (since < 1.0) {
    delay_ = std::min(2.0 * delay_, kMost);
    return;
  }
  for (int second = 1; second <= since && delay_ > kLeast; ++second) delay_ = std::max(0.5 * delay_, kLeast);
}

}  // namespace fathom::launch
