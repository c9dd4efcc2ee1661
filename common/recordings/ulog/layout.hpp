// Where the numbers of an ULog message are: its format with everything nested laid out flat.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/recordings/file_window.hpp"

namespace fathom::recordings::ulog {

/// One number, or a text of `count` letters.
struct Place {
  std::string name;
  char type{};  ///< b B h H i I q Q f d ? (bool), c (text)
  std::size_t offset{};
  std::size_t count{1};
};

struct Layout {
  std::vector<Place> places;
  std::size_t size{};    ///< bytes in memory
  std::size_t stored{};  ///< bytes in a message: padding at the end is left out
};

/// The 'F' messages of a file.
class Formats {
 public:
  /// "name:type field;..."; false when it is no format.
  bool add(std::string_view text);
  /// Nothing when a type is not known, or more than a message can hold.
  [[nodiscard]] std::optional<Layout> layout(const std::string& name) const;

 private:
  struct Member {
    std::string type, name;
    std::size_t count{1};
    bool list{};
  };
  bool lay_out(const std::string& name, const std::string& path, int depth, Layout& layout) const;
  std::map<std::string, std::vector<Member>> formats_;
};

/// The number at a place.
[[nodiscard]] double number(const Place& place, Bytes message);

}  // namespace fathom::recordings::ulog
