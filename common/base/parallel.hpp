// Independent pieces of work, side by side. Each piece writes its own result, so the outcome does not depend on who is
// first.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace fathom {

/// Calls `work(i)` once for every i below `count`, on at most `threads` threads. `work` must not throw.
template <typename Work>
void for_each_index(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> pool;
  const auto helpers = std::min(static_cast<std::size_t>(std::max(threads - 1, 0)), count > 0 ? count - 1 : 0);
  for (std::size_t i = 0; i < helpers; ++i) pool.emplace_back(take);
  take();
}

}  // namespace fathom
