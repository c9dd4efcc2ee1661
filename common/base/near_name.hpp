// Which names are likely to be each other misspelt.
#pragma once

#include <string_view>

namespace fathom {

/// True for names that differ by a slip or two of the keyboard, by capitals, or by dashes for underscores.
[[nodiscard]] bool looks_like(std::string_view a, std::string_view b);

}  // namespace fathom
