// A number with three digits, as sentences for people have it.
#pragma once

#include <cstdio>
#include <string>

namespace fathom {

[[nodiscard]] inline std::string brief_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace fathom
