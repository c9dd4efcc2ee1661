// The board's listening socket, or why there is none and what to do about it.
#pragma once

#include <string>

namespace fathom::board {

/// Non-blocking; `port` 0 becomes the one that was free. InputError.
[[nodiscard]] int listen_at(const std::string& host, int& port);

}  // namespace fathom::board
