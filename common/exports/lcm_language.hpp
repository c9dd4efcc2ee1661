// LCM's language: what an .lcm file says of its message types.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fathom::exports {

struct Field {
  std::string type;  ///< "double", "int64_t", ..., or the name of another type
  std::string name;
  std::vector<std::string> sizes;  ///< of an array: numbers, or names of earlier fields
  std::string comment;             ///< "[m] Bo from Wo, in W (NED)"
  [[nodiscard]] bool primitive() const;
};

struct Type {
  std::string package, name, comment;
  std::vector<Field> fields;
};

/// All structs of a text. Comments before a struct are its own, those beside and below a field the field's; constants
/// are passed over. InputError "file:line: what"; `path` stands for the file.
[[nodiscard]] std::vector<Type> types_in(std::string_view text, const std::string& path);

}  // namespace fathom::exports
