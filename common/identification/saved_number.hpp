// Numbers in the text of a saved state, to the last bit.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <istream>
#include <optional>
#include <string>

namespace fathom::identification {

inline void put_number(std::string& text, double value) {
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "%a ", value);  // exact
  text += number.data();
}

/// Nothing where the text ends.
inline std::optional<double> take_number(std::istream& text) {
  std::string word;
  if (!(text >> word)) return {};
  return std::strtod(word.c_str(), nullptr);
}

}  // namespace fathom::identification
