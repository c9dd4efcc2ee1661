// Columns of a stranger's table by their usual names, for the draft of a map: which one bears a name, in which unit, in
// which range.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "common/tables/csv.hpp"

namespace fathom::recordings {

/// Names of one component, lower case, best first; a column of the same words in other order or writing comes after all
/// that are called exactly so (column_words.hpp). A name that begins with a point stands for every name that ends so.
using Choices = std::vector<std::string>;

[[nodiscard]] std::string lower_case(std::string text);

struct Column {
  const std::string* name{};
  std::string bare;  ///< lower case, without a unit at its end
  std::vector<std::string> words;
  std::string unit;  ///< as the header or the name's end says; empty: neither does
  double least{}, greatest{};
  std::size_t count{};  ///< numbers in it
};

class Columns {
 public:
  explicit Columns(const tables::CsvTable& table);
  [[nodiscard]] const std::vector<Column>& all() const { return all_; }
  /// The column of the first choice that is there and holds numbers.
  [[nodiscard]] const Column* find(const Choices& choices) const;

  [[nodiscard]] bool holds_numbers(std::size_t i) const;

 private:
  const tables::CsvTable& table_;
  std::vector<Column> all_;
};

/// Up to as many columns as there are components.
struct Group {
  std::vector<const Column*> columns;

  Group(const Columns& all, const std::vector<Choices>& components);
  explicit Group(std::vector<const Column*> known) : columns{std::move(known)} {}
  [[nodiscard]] std::size_t there() const;
  [[nodiscard]] bool whole() const { return there() == columns.size(); }
  /// As a map lists them; `none` where there is none.
  [[nodiscard]] std::string list() const;
  [[nodiscard]] double largest() const;
  /// What a header says, where it is a unit of `dimension`; else `otherwise`.
  [[nodiscard]] std::string unit(const char* dimension, const std::string& otherwise) const;
};

/// A line of a map: `key` of these columns.
[[nodiscard]] std::string vector_line(const char* key, const Group& group, const std::string& unit, const char* frame);
/// Degrees where some value is beyond a full turn of radians; rates where they are faster than any craft turns.
[[nodiscard]] std::string angle_unit(const Group& group);
[[nodiscard]] std::string rate_unit(const Group& group);

}  // namespace fathom::recordings
