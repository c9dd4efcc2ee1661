// The message types of a log as their .lcm files define them: read from the text, so that any channel can be exported
// and every column carries its comment (unit and frame) with it.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/exports/lcm_language.hpp"

namespace fathom::exports {

/// All types by "package.name".
class Definitions {
 public:
  /// Of .lcm texts; `paths` stand for them in messages. InputError for what cannot be read, or names a type that none
  /// of them has.
  explicit Definitions(std::span<const std::string_view> texts, std::span<const std::string> paths = {});
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
