// Names of test cases as ctest and doctest need them written.
#pragma once

#include <string>
#include <string_view>

namespace fathom::test {

/// An entry of ctest has a name of one line.
inline bool can_be_an_entry(std::string_view name) {
  return !name.empty() && name.find_first_of("\r\n") == std::string_view::npos;
}

/// A bracket argument of CMake: nothing in it has a meaning, as long as its end does not occur in it.
inline std::string cmake_literal(std::string_view text) {
  std::string equals;
  const auto closing = [&] { return "]" + equals + "]"; };
  while ((std::string{text} + closing()).find(closing()) < text.size()) equals += '=';
  return "[" + equals + "[" + std::string{text} + closing();
}

/// A filter of doctest that this name passes: a comma would end it. Stars and question marks pass themselves, and more;
/// who filters counts what ran.
inline std::string doctest_filter(std::string_view name) {
  std::string filter;
  for (const char c : name) {
    if (c == ',' || c == '\\') filter += '\\';
    filter += c;
  }
  return filter;
}

}  // namespace fathom::test
