// A row of a channel's table to the message that it was, by the type's definition: the reverse of decoded().
#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/base/time.hpp"
#include "common/exports/definitions.hpp"

namespace fathom::exports {

template <std::unsigned_integral Value>
void append_big(std::vector<std::uint8_t>& bytes, Value value) {
  for (std::size_t i = sizeof value; i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// "17", and "17.0" as spreadsheets leave it; nothing for a text that is no whole number.
[[nodiscard]] std::optional<std::int64_t> whole_of(std::string_view text);

class TableMessage {
 public:
  /// `names` are those of the columns of the table `path`.
  TableMessage(const Definitions& definitions, const Type& type, std::string path, std::span<const std::string> names);

  /// InputError "file:line: what" for a cell that cannot be what its column says. An empty cell of a real number is
  /// NaN; bytes of a fixed number, which a table does not hold, are zeros.
  void encode(std::span<const std::string> cells, std::uint64_t line, std::vector<std::uint8_t>& bytes);
  [[nodiscard]] std::int64_t whole(const std::string& name, std::span<const std::string> cells,
                                   std::uint64_t line) const;
  /// Of a column in seconds.
  [[nodiscard]] Utime microseconds(const std::string& name, std::span<const std::string> cells,
                                   std::uint64_t line) const;

 private:
  struct Row;
  using Counts = std::map<std::string, std::int64_t>;
  void structure(const Type& type, const std::string& name, const Row& row) const;
  void value(const Type& type, const Field& field, const std::string& name, std::size_t dimension, const Row& row,
             Counts& counts) const;
  void scalar(const Type& type, const Field& field, const std::string& name, const Row& row, Counts& counts) const;
  [[nodiscard]] const std::string& cell(const std::string& name, const Row& row) const;
  [[nodiscard]] std::int64_t whole(const std::string& name, const Row& row, std::int64_t lowest,
                                   std::int64_t highest) const;
  [[noreturn]] void fail(const std::string& name, const Row& row, const std::string& what) const;

  const Definitions& definitions_;
  const Type& type_;
  std::string path_;
  std::size_t width_;
  std::uint64_t fingerprint_;
  std::unordered_map<std::string, std::size_t> places_;
};

}  // namespace fathom::exports
