#include "common/estimation/wording.hpp"

#include <array>
#include <cstdio>

namespace fathom::estimation {

std::string text(const char* format, double a, double b, double c, double d, double e, double f) {
  std::array<char, 256> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, a, b, c, d, e, f);
  return buffer.data();
}

}  // namespace fathom::estimation
