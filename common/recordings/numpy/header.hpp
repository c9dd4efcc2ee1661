// The header of a .npy: a dictionary of Python as text, of which three keys count.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::recordings::numpy {

/// A number within an element: all of it, or a member of a structured one.
struct Member {
  std::string name;      ///< empty: the element itself
  bool big{};            ///< greatest byte first
  char kind{};           ///< b i u f, M (date); others are passed over
  std::size_t size{};    ///< bytes
  std::size_t offset{};  ///< in the element
  double to_seconds{};   ///< of a date
};

struct Header {
  std::vector<Member> members;
  std::size_t element{};  ///< bytes
  std::vector<std::size_t> shape;
  bool fortran{};  ///< the first index runs fastest
};

/// Nothing, with the reason, for what is not understood.
[[nodiscard]] std::optional<Header> header_of(std::string_view text, std::string& reason);

}  // namespace fathom::recordings::numpy
