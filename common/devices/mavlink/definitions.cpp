#include "common/devices/mavlink/definitions.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "common/devices/checksum.hpp"

namespace fathom::devices::mavlink {
namespace {

struct Row {
  std::uint32_t id;
  std::string_view name;
  std::uint8_t crc_extra;
  std::string_view fields;
};

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): a row of the table
#define MAVLINK_MESSAGE(id, name, extra, fields) Row{id, #name, extra, fields},
// Not std::array's own deduction: for so many rows it nests deeper than clang goes.
constexpr auto kRows = std::to_array<Row>({
#include "common/devices/mavlink/messages.def"
});
#undef MAVLINK_MESSAGE

std::string_view type_name(char letter) {
  constexpr std::array<std::pair<char, std::string_view>, 11> kTypes{{{'B', "uint8_t"},
                                                                      {'H', "uint16_t"},
                                                                      {'I', "uint32_t"},
                                                                      {'Q', "uint64_t"},
                                                                      {'b', "int8_t"},
                                                                      {'h', "int16_t"},
                                                                      {'i', "int32_t"},
                                                                      {'q', "int64_t"},
                                                                      {'f', "float"},
                                                                      {'d', "double"},
                                                                      {'c', "char"}}};
  return std::ranges::find(kTypes, letter, &std::pair<char, std::string_view>::first)->second;
}

Definition read(const Row& row) {
  Definition definition{.id = row.id, .name = row.name, .crc_extra = row.crc_extra, .fields = {}, .length = 0};
  std::string_view rest = row.fields;
  std::size_t offset = 0;
  bool extension = false;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of(",|"), rest.size());
    const std::string_view one = rest.substr(0, end);
    const std::size_t gap = one.find(' ');
    DefinedField field{.letter = one[0], .name = one.substr(gap + 1), .offset = offset, .extension = extension};
    field.list = gap > 1;
    if (field.list) std::from_chars(one.data() + 1, one.data() + gap, field.count);
    offset += field.count * size_of(field.letter);
    if (!extension) definition.length = offset;
    definition.fields.push_back(field);
    extension = extension || (end < rest.size() && rest[end] == '|');
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return definition;
}

}  // namespace

std::size_t size_of(char letter) {
  switch (letter) {
    case 'Q':
    case 'q':
    case 'd':
      return 8;
    case 'I':
    case 'i':
    case 'f':
      return 4;
    case 'H':
    case 'h':
      return 2;
    default:
      return 1;
  }
}

std::span<const Definition> definitions() {
  static const std::vector<Definition> all = [] {
    std::vector<Definition> read_rows;
    for (const Row& row : kRows) read_rows.push_back(read(row));
    std::ranges::sort(read_rows, {}, &Definition::id);
    return read_rows;
  }();
  return all;
}

const Definition* definition(std::uint32_t id) {
  const std::span<const Definition> all = definitions();
  const auto found = std::ranges::lower_bound(all, id, {}, &Definition::id);
  return found == all.end() || found->id != id ? nullptr : &*found;
}

std::uint8_t computed_extra(const Definition& definition) {
  std::string text = std::string{definition.name} + " ";
  for (const DefinedField& field : definition.fields) {
    if (field.extension) break;
    text += std::string{type_name(field.letter)} + " " + std::string{field.name} + " ";
    if (field.list) text += static_cast<char>(field.count);
  }
  const std::uint16_t crc = crc16_reflected(as_bytes(text), 0xFFFF);
  return static_cast<std::uint8_t>((crc & 0xFFU) ^ (crc >> 8U));
}

}  // namespace fathom::devices::mavlink
