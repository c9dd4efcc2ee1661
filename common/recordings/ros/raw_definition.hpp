// Definitions as they are written: members by the names of their types, nothing looked up yet.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::recordings::ros {

struct RawMember {
  std::string type, name;
  bool list{};
  std::size_t count{};  ///< of a list of fixed length, else 0
};

/// By "pkg/Type".
using RawDefinitions = std::map<std::string, std::vector<RawMember>>;

/// Text of .msg files: `name`'s first, the others behind lines of `=` and "MSG: pkg/Type".
[[nodiscard]] RawDefinitions raw_from_msg(const std::string& name, std::string_view text);
/// Text of .idl files, one or several: modules, structs, typedefs, constants; annotations are passed over.
[[nodiscard]] RawDefinitions raw_from_idl(std::string_view text);

}  // namespace fathom::recordings::ros
