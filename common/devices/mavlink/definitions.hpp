// MAVLink's messages by number: name, fields, and the extra byte of the checksum that stands for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::devices::mavlink {

/// A field where it stands on the wire. Bytes that are not sent are zero; extensions may be absent altogether.
struct DefinedField {
  char letter{};         ///< B H I Q, b h i q, f d, c (text)
  std::size_t count{1};  ///< of a list
  bool list{};
  std::string_view name;
  std::size_t offset{};  ///< bytes from the beginning of the payload
  bool extension{};
};

struct Definition {
  std::uint32_t id{};
  std::string_view name;
  std::uint8_t crc_extra{};
  std::vector<DefinedField> fields;
  std::size_t length{};  ///< bytes of the payload without extensions
};

/// In the order of their numbers.
[[nodiscard]] std::span<const Definition> definitions();
/// Null when no dialect that is known here has it.
[[nodiscard]] const Definition* definition(std::uint32_t id);
/// Bytes of one element.
[[nodiscard]] std::size_t size_of(char letter);
/// The extra byte as the fields give it; for the test of the table.
[[nodiscard]] std::uint8_t computed_extra(const Definition& definition);

}  // namespace fathom::devices::mavlink
