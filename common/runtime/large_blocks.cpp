#include "common/runtime/large_blocks.hpp"

#include <malloc.h>

namespace fathom::runtime {

void give_back_large_blocks() {
  constexpr int kLarge = 128 * 1024;  // B; the C library's own beginning, which it moves up where it is not stated
  mallopt(M_MMAP_THRESHOLD, kLarge);
}

}  // namespace fathom::runtime
