// The message types of a log as their .lcm files define them: read from the text, so that any channel can be exported
// and every column carries its comment (unit and frame) with it.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::exports {

struct Field {
  std::string type;  ///< "double", "int64_t", ..., or the name of another type
  std::string name;
  std::vector<std::string> sizes;  ///< of an array: numbers, or names of earlier fields
  std::string comment;             ///< "[m] Bo from Wo, in W (NED)"
  [[nodiscard]] bool primitive() const { return type.find("_t") == std::string::npos || type.starts_with("int"); }
};

struct Type {
  std::string package, name, comment;
  std::vector<Field> fields;
};

/// All types by "package.name".
class Definitions {
 public:
  /// Of .lcm texts, a type each. InputError for what cannot be read.
  explicit Definitions(std::span<const std::string_view> texts);
  /// Those that this build was made with.
  [[nodiscard]] static const Definitions& built_in();

  /// The type of an encoded message, by the fingerprint that it begins with; null where it is none of these.
  [[nodiscard]] const Type* type_of(std::span<const std::uint8_t> message) const;
  [[nodiscard]] const Type& type(const std::string& package, const std::string& name) const;
  [[nodiscard]] std::uint64_t fingerprint(const Type& type) const;
  [[nodiscard]] const std::map<std::string, Type>& all() const { return types_; }

 private:
  [[nodiscard]] std::uint64_t summed(const Type& type, std::vector<const Type*>& above) const;

  std::map<std::string, Type> types_;
  std::map<std::uint64_t, const Type*> by_fingerprint_;
};

/// Texts of the .lcm files (made by cmake).
[[nodiscard]] std::span<const std::string_view> definition_texts();

}  // namespace fathom::exports
