// The offline tool, a small vehicle and a table for it, and what a refusal looks like.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom::test {

inline const std::string kOfflineTool = program("fathom");

inline constexpr char kSledFile[] =
    "name: Sled\ndof: [surge, yaw]\nwater_density: 1000 kg/m^3\nmass: 20 kg\ninertia: 0.5 0.8 1 kg m^2\n";

/// Canonical columns, written out by hand: 30 s of a slow turn.
inline std::string table(const std::string& header, const std::string& bad_cell = "0.1") {
  std::string text = header + "\n";
  for (int i = 0; i < 300; ++i) {
    text += std::to_string(0.1 * i);
    for (int k = 1; k < 13; ++k) text += "," + (i == 7 && k == 4 ? bad_cell : std::to_string(0.01 * (i % 17) + k));
    text += "\n";
  }
  return text;
}

inline void one_line(const Ran& ran, int code, const std::string& words) {
  CAPTURE(ran.text);
  CHECK(ran.code == code);
  CHECK(ran.lines() == 1);
  CHECK(ran.text.starts_with("fathom: "));
  CHECK(ran.says(words));
}

}  // namespace fathom::test
