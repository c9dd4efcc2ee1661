// What becomes of large blocks of memory that a program has let go.
#pragma once

namespace fathom::runtime {

/// Blocks of 128 KiB and more go back to the system when they are let go, for the rest of the process. The C library
/// would keep them from the first on that is freed, in pieces that a search, whose columns differ in length, cannot use
/// again. To be called before there are threads.
void give_back_large_blocks();

}  // namespace fathom::runtime
