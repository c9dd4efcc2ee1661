#include "common/runtime/large_blocks.hpp"

#include <doctest/doctest.h>
#include <malloc.h>

#include <cstddef>
#include <memory>

namespace fathom::runtime {

#ifndef __SANITIZE_ADDRESS__  // which has memory of its own
TEST_CASE("large blocks: each is a piece of the system's, also when a larger one was let go before") {
  give_back_large_blocks();
  constexpr std::size_t kMegabyte = 1 << 20;
  std::make_unique<std::byte[]>(8 * kMegabyte).reset();
  const std::size_t before = mallinfo2().hblks;
  auto block = std::make_unique<std::byte[]>(kMegabyte);
  CHECK(mallinfo2().hblks == before + 1);
  block.reset();
  CHECK(mallinfo2().hblks == before);
}
#endif

}  // namespace fathom::runtime
