#include "common/tables/csv.hpp"

#include <algorithm>
#include <array>
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

// One cell, `line` moves on behind it and `more` tells whether another follows. In quotes a separator is text.
std::string_view take_cell(std::string_view& line, char separator, bool& more) {
  const auto begin = std::min(line.find_first_not_of(" \t"), line.size());
  std::size_t end = line.find(separator);
  if (begin < end && begin < line.size() && line[begin] == '"') {
    const auto closed = line.find('"', begin + 1);
    if (closed != std::string_view::npos) end = line.find(separator, closed);
  }
  std::string_view cell = trim(line.substr(0, end));
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = trim(cell.substr(1, cell.size() - 2));
  more = end != std::string_view::npos;
  if (more) line.remove_prefix(end + 1);
  return cell;
}

// The next line without its end; `text` moves on.
std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

constexpr std::size_t kLongest = 64;  // characters of a number with a decimal comma
constexpr double kFill = 1e30;        // and more is what loggers write for "no value": FLT_MAX, 1e38, DBL_MAX

// NaN for a missing or infinite number, and for a fill value; false when the cell is no number at all. Where columns
// are parted by semicolons a decimal comma is a point.
bool read_number(std::string_view cell, char separator, double& value) {
  value = kMissing;
  if (cell.empty()) return true;
  if (cell.front() == '+') cell.remove_prefix(1);
  std::array<char, kLongest> copy;
  if (const auto comma = cell.find(','); separator == ';' && comma != std::string_view::npos) {
    if (cell.size() > copy.size()) return false;
    std::ranges::copy(cell, copy.begin());
    copy[comma] = '.';
    cell = {copy.data(), cell.size()};
  }
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool whole = error == std::errc{} && end == cell.data() + cell.size();
  if (!whole || !(std::abs(value) < kFill)) value = kMissing;
  return whole;
}

/// A picture, a log or an archive begins with bytes that no text has.
void check_text(std::string_view text, const std::string& path) {
  const auto strange = [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r' && c != '\n';
  };
  if (std::ranges::any_of(text.substr(0, kFirstBytes), strange))
    throw InputError(path + ": this is no text; give a table with commas between its columns");
}

/// What parts the columns of a header: a comma, or where there is none a semicolon or a tab, as spreadsheets write.
/// InputError for anything else, since such a table is one column to us.
char separator_of(std::string_view line, const std::string& where) {
  line = trim(line);
  for (const char one : {',', ';', '\t'}) {
    if (line.find(one) != std::string_view::npos) return one;
  }
  const auto other = line.find_first_of("| ");
  if (other == std::string_view::npos || line.front() == '"') return ',';
  throw InputError(where + ": separator " + (line[other] == ' ' ? "blank" : "'|'") +
                   ": save the table with commas between its columns");
}

std::vector<std::string> read_names(std::string_view line, char separator, const std::string& where) {
  std::vector<std::string> names;
  for (bool more = true; more;) {
    const std::string_view name = take_cell(line, separator, more);
    if (name.empty())
      throw InputError(where + ": column " + std::to_string(names.size() + 1) +
                       " has no name; give it one, or take its separator away");
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      throw InputError(where + ": column '" + std::string(name) + "' stands here twice");
    }
    names.emplace_back(name);
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
  char separator = ',';
  while (!text.empty()) {
    std::string_view line = take_line(text);
    ++number;
    if (trim(line).empty() || trim(line).front() == '#') continue;
    if (table.names.empty()) {
      separator = separator_of(line, path + ":" + std::to_string(number));
      table.names = read_names(line, separator, path + ":" + std::to_string(number));
      table.columns.resize(table.names.size());
      table.faults.resize(table.names.size());
      for (auto& column : table.columns) column.reserve(expected_rows);
      table.lines.reserve(expected_rows);
      continue;
    }
    std::size_t cells = 0;
    for (bool more = true; more; ++cells) {
      const std::string_view cell = take_cell(line, separator, more);
      if (cells >= table.columns.size()) continue;
      double value{};
      std::string& fault = table.faults[cells];
      if (!read_number(cell, separator, value) && fault.empty()) {
        fault = path + ":" + std::to_string(number) + ": column '" + table.names[cells] + "': '" +
                std::string(cell.substr(0, kShownCell)) + "' is not a number";
      }
      table.columns[cells].push_back(value);
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
