#include "common/tables/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "common/base/error.hpp"

namespace fathom::tables {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kShownCell = 24;     // characters of a bad cell that a message repeats
constexpr std::size_t kFirstBytes = 1024;  // that tell a text from what is none

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// The next line without its end; `text` moves on.
std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

constexpr double kFill = 1e30;  // and more is what loggers write for "no value": FLT_MAX, 1e38, DBL_MAX

// NaN for a missing or infinite number, and for a fill value; false when the cell is no number at all.
bool read_number(std::string_view cell, double& value) {
  value = kMissing;
  if (cell.empty()) return true;
  if (cell.front() == '+') cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size()) return false;
  if (!(std::abs(value) < kFill)) value = kMissing;
  return true;
}

/// A picture, a log or an archive begins with bytes that no text has.
void check_text(std::string_view text, const std::string& path) {
  const auto strange = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r' && c != '\n';
  };
  if (std::ranges::any_of(text.substr(0, kFirstBytes), strange))
    throw InputError(path + ": this is no text; give a table with commas between its columns");
}

/// A table whose columns are parted by something else is one column to us, and its first row no number.
void check_separator(std::string_view line, const std::string& where) {
  if (line.find(',') != std::string_view::npos) return;
  const auto other = trim(line).find_first_of(";\t|");
  if (other == std::string_view::npos) return;
  const char separator = trim(line)[other];
  throw InputError(where + ": separator " + (separator == '\t' ? "tab" : std::string("'") + separator + "'") +
                   ": save the table with commas between its columns, and with points in its numbers");
}

std::vector<std::string> read_names(std::string_view line, const std::string& where) {
  check_separator(line, where);
  std::vector<std::string> names;
  for (bool more = true; more;) {
    const auto comma = line.find(',');
    std::string_view name = trim(line.substr(0, comma));
    if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    if (name.empty()) throw InputError(where + ": column " + std::to_string(names.size() + 1) + " has no name");
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      throw InputError(where + ": column '" + std::string(name) + "' stands here twice");
    }
    names.emplace_back(name);
    more = comma != std::string_view::npos;
    if (more) line.remove_prefix(comma + 1);
  }
  return names;
}

}  // namespace

const std::vector<double>* CsvTable::find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &columns[static_cast<std::size_t>(found - names.begin())];
}

std::string CsvTable::where(std::size_t row) const {
  return path + ":" + std::to_string(row < lines.size() ? lines[row] : 1);
}

CsvTable parse_csv(std::string_view text, const std::string& path) {
  CsvTable table;
  table.path = path;
  check_text(text, path);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  const auto expected_rows = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  std::size_t number = 0;
  while (!text.empty()) {
    std::string_view line = take_line(text);
    ++number;
    if (trim(line).empty() || line.front() == '#') continue;
    if (table.names.empty()) {
      table.names = read_names(line, path + ":" + std::to_string(number));
      table.columns.resize(table.names.size());
      for (auto& column : table.columns) column.reserve(expected_rows);
      table.lines.reserve(expected_rows);
      continue;
    }
    std::size_t cells = 0;
    for (bool more = true; more; ++cells) {
      const auto comma = line.find(',');
      const std::string_view cell = trim(line.substr(0, comma));
      if (cells < table.columns.size()) {
        double value{};
        if (!read_number(cell, value)) {
          throw InputError(path + ":" + std::to_string(number) + ": column '" + table.names[cells] + "': '" +
                           std::string(cell.substr(0, kShownCell)) + "' is not a number");
        }
        table.columns[cells].push_back(value);
      }
      more = comma != std::string_view::npos;
      if (more) line.remove_prefix(comma + 1);
    }
    if (cells != table.names.size()) {
      throw InputError(path + ":" + std::to_string(number) + ": this row has " + std::to_string(cells) +
                       " cells, the header names " + std::to_string(table.names.size()) +
                       (text.empty() ? " (was the file cut off?)" : ""));
    }
    table.lines.push_back(number);
  }
  if (table.names.empty()) throw InputError(path + ": the file is empty");
  if (table.rows() == 0) throw InputError(path + ": there is a header but not one row of numbers");
  return table;
}

CsvTable read_csv(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || std::filesystem::is_directory(path)) throw InputError(path + ": cannot read this file");
  std::string text(static_cast<std::size_t>(file.tellg()), '\0');
  file.seekg(0);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file) throw InputError(path + ": cannot read this file to its end");
  return parse_csv(text, path);
}

}  // namespace fathom::tables
