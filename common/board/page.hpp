// The page that shows the board, as it is sent: the files of common/board/page, compiled in.
#pragma once

#include <string_view>

namespace fathom::board {

extern const std::string_view kPage, kStyle, kDrawing, kScript;

}  // namespace fathom::board
