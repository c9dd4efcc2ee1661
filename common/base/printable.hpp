// What strangers say shall not command an operator's terminal.
#pragma once

#include <string>
#include <string_view>

namespace fathom {

/// The text with '?' for whatever is not printable ASCII, cut after `longest` characters.
[[nodiscard]] inline std::string printable(std::string_view text, std::size_t longest = std::string_view::npos) {
  std::string clean{text.substr(0, longest)};
  for (char& c : clean) {
    if (c < ' ' || c > '~') c = '?';
  }
  return clean;
}

}  // namespace fathom
