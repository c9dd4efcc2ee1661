// Small words of a verdict.
#pragma once

#include <string>
#include <vector>

namespace fathom::diagnosis {

[[nodiscard]] std::string percent(double share);
/// "a, b and c".
[[nodiscard]] std::string joined(const std::vector<std::string>& words, const std::string& last = " and ");

/// A printf format with one number in it.
[[nodiscard]] std::string with_number(const char* format, double value);

}  // namespace fathom::diagnosis
