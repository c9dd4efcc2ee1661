#include "common/exports/table_message.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "common/base/error.hpp"

namespace fathom::exports {
namespace {

std::optional<double> real_of(std::string_view text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (text.empty()) return value;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional{value} : std::nullopt;
}

template <class Whole>
std::pair<std::int64_t, std::int64_t> range_of() {
  return {std::numeric_limits<Whole>::min(), std::numeric_limits<Whole>::max()};
}

}  // namespace

std::optional<std::int64_t> whole_of(std::string_view text) {
  std::int64_t value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc{} && end == text.data() + text.size()) return value;
  constexpr double kExact = 9007199254740992.0;  // 2^53
  const std::optional<double> real = text.empty() ? std::nullopt : real_of(text);
  if (!real || *real != std::round(*real) || !(std::abs(*real) <= kExact)) return std::nullopt;
  return static_cast<std::int64_t>(*real);
}

struct TableMessage::Row {
  std::span<const std::string> cells;
  std::uint64_t line{};
  std::vector<std::uint8_t>* bytes{};
};

TableMessage::TableMessage(const Definitions& definitions, const Type& type, std::string path,
                           std::span<const std::string> names)
    : definitions_{definitions},
      type_{type},
      path_{std::move(path)},
      width_{names.size()},
      fingerprint_{definitions.fingerprint(type)} {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!places_.try_emplace(names[i], i).second)
      throw InputError(path_ + ":1: column '" + names[i] + "' stands here twice");
  }
}

void TableMessage::fail(const std::string& name, const Row& row, const std::string& what) const {
  throw InputError(path_ + ":" + std::to_string(row.line) + ": " + (name.empty() ? "" : "column '" + name + "': ") +
                   what);
}

const std::string& TableMessage::cell(const std::string& name, const Row& row) const {
  const auto found = places_.find(name);
  if (found == places_.end()) fail(name, row, "is not in the table, and a message of this row needs it");
  return row.cells[found->second];
}

std::int64_t TableMessage::whole(const std::string& name, const Row& row, std::int64_t lowest,
                                 std::int64_t highest) const {
  const std::string& text = cell(name, row);
  const std::optional<std::int64_t> value = whole_of(text);
  if (!value || *value < lowest || *value > highest) fail(name, row, "'" + text + "' is no whole number that fits it");
  return *value;
}

std::int64_t TableMessage::whole(const std::string& name, std::span<const std::string> cells,
                                 std::uint64_t line) const {
  const auto [lowest, highest] = range_of<std::int64_t>();
  return whole(name, {.cells = cells, .line = line}, lowest, highest);
}

Utime TableMessage::microseconds(const std::string& name, std::span<const std::string> cells,
                                 std::uint64_t line) const {
  const Row row{.cells = cells, .line = line};
  const std::optional<double> seconds = real_of(cell(name, row));
  constexpr double kLongest = 1e12;  // s
  if (!seconds || !(std::abs(*seconds) < kLongest)) fail(name, row, "'" + cell(name, row) + "' is no time");
  return std::llround(1e6 * *seconds);
}

void TableMessage::encode(std::span<const std::string> cells, std::uint64_t line, std::vector<std::uint8_t>& bytes) {
  const Row row{.cells = cells, .line = line, .bytes = &bytes};
  if (cells.size() != width_)
    fail("", row,
         "this row has " + std::to_string(cells.size()) + " cells, the header names " + std::to_string(width_));
  bytes.clear();
  append_big(bytes, fingerprint_);
  structure(type_, "", row);
}

void TableMessage::structure(const Type& type, const std::string& name, const Row& row) const {
  Counts counts;
  for (const Field& field : type.fields)
    value(type, field, name.empty() ? field.name : name + "." + field.name, 0, row, counts);
}

void TableMessage::value(const Type& type, const Field& field, const std::string& name, std::size_t dimension,
                         const Row& row, Counts& counts) const {
  if (dimension == field.sizes.size()) {
    scalar(type, field, name, row, counts);
    return;
  }
  const std::string& size = field.sizes[dimension];
  const auto known = counts.find(size);
  const std::int64_t count = known != counts.end() ? known->second : std::stoll(size);
  if (count < 0) fail(size, row, "a list cannot have " + std::to_string(count) + " elements");
  if (field.type == "byte") {
    row.bytes->insert(row.bytes->end(), static_cast<std::size_t>(count), 0);
    return;
  }
  // As many as there are columns at most: the first that is missing is named.
  for (std::int64_t i = 0; i < count; ++i)
    value(type, field, name + "[" + std::to_string(i) + "]", dimension + 1, row, counts);
}

void TableMessage::scalar(const Type& type, const Field& field, const std::string& name, const Row& row,
                          Counts& counts) const {
  std::vector<std::uint8_t>& bytes = *row.bytes;
  const auto take = [&]<class Whole>(Whole) {
    const auto [lowest, highest] = range_of<Whole>();
    const std::int64_t number = whole(name, row, lowest, highest);
    counts[field.name] = number;
    append_big(bytes, static_cast<std::make_unsigned_t<Whole>>(number));
  };
  if (field.type == "double" || field.type == "float") {
    const std::string& text = cell(name, row);
    const std::optional<double> number = real_of(text);
    if (!number) fail(name, row, "'" + text + "' is not a number");
    if (field.type == "double") {
      append_big(bytes, std::bit_cast<std::uint64_t>(*number));
    } else {
      append_big(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(*number)));
    }
  } else if (field.type == "int64_t") {
    take(std::int64_t{});
  } else if (field.type == "int32_t") {
    take(std::int32_t{});
  } else if (field.type == "int16_t") {
    take(std::int16_t{});
  } else if (field.type == "int8_t") {
    take(std::int8_t{});
  } else if (field.type == "byte") {
    take(std::uint8_t{});
  } else if (field.type == "boolean") {
    const std::string& text = cell(name, row);
    const bool yes = text == "true" || text == "True" || text == "TRUE" || text == "1";
    if (!yes && text != "false" && text != "False" && text != "FALSE" && text != "0")
      fail(name, row, "'" + text + "' is neither true nor false");
    bytes.push_back(yes ? 1 : 0);
  } else if (field.type == "string") {
    const std::string& text = cell(name, row);
    append_big(bytes, static_cast<std::uint32_t>(text.size() + 1));
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back(0);
  } else {
    structure(definitions_.type(type.package, field.type), name, row);
  }
}

}  // namespace fathom::exports
