#include "common/tables/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/tables/date_text.hpp"

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

/// What loggers write where there is no value.
bool is_none(std::string_view cell) {
  constexpr std::array<std::string_view, 8> kNone{"N/A", "n/a", "NA", "null", "NULL", "None", "none", "NaT"};
  if (std::ranges::find(kNone, cell) != kNone.end()) return true;
  const auto dash = [](char c) { return c == '-' || c == '.' || c == ':'; };
  return cell.front() == '-' && std::ranges::all_of(cell, dash);  // "-", "--.--", "--:--"
}

// NaN for a missing or infinite number, and for a fill value; false when the cell is no number at all. Where columns
// are parted by semicolons a decimal comma is a point.
bool read_number(std::string_view cell, char separator, double& value) {
  value = kMissing;
  if (cell.empty() || is_none(cell)) return true;
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

void read_names(std::string_view line, char separator, const std::string& where, CsvTable& table) {
  std::vector<std::string> headers;
  for (bool more = true; more;) {
    const std::string_view name = take_cell(line, separator, more);
    if (name.empty())
      throw InputError(where + ": column " + std::to_string(headers.size() + 1) +
                       " has no name; give it one, or take its separator away");
    if (std::find(headers.begin(), headers.end(), name) != headers.end()) {
      throw InputError(where + ": column '" + std::string(name) + "' stands here twice");
    }
    headers.emplace_back(name);
  }
  std::vector<NameAndUnit> parted;
  for (const std::string& header : headers) parted.push_back(part_unit(header));
  for (std::size_t i = 0; i < headers.size(); ++i) {
    // "x [m]" beside "x [ft]": only with their units are they two.
    const auto same = [&](const NameAndUnit& other) { return other.name == parted[i].name; };
    const bool alone = std::ranges::count_if(parted, same) == 1;
    table.names.push_back(alone ? parted[i].name : headers[i]);
    table.units.push_back(parted[i].unit);
  }
  table.columns.resize(headers.size());
  table.faults.resize(headers.size());
  table.cells.resize(headers.size(), Cells::kNumbers);
}

bool is_comment(std::string_view line) { return line.front() == '#' || line.front() == '%'; }

/// Whether all cells of a line are numbers, or dates, or empty, and at least one is there: no header, then.
bool holds_numbers(std::string_view line, char separator) {
  std::size_t values = 0;
  for (bool more = true; more;) {
    const std::string_view cell = take_cell(line, separator, more);
    double value{};
    if (!read_number(cell, separator, value) && !read_date(cell)) return false;
    values += std::isfinite(value) ? 1 : 0;
  }
  return values > 0;
}

std::size_t count_cells(std::string_view line, char separator) {
  std::size_t count = 0;
  for (bool more = true; more; ++count) static_cast<void>(take_cell(line, separator, more));
  return count;
}

/// A date in a column: seconds, and what the column holds. False when it is none, or of another kind than those before.
bool read_date_cell(std::string_view cell, std::size_t column, CsvTable& table, double& value) {
  const std::optional<DateText> date = read_date(cell);
  if (!date) return false;
  const Cells kind = date->time_only ? Cells::kTimesOfDay : Cells::kDates;
  const auto number = [](double one) { return std::isfinite(one); };
  if (table.cells[column] == Cells::kNumbers) {
    if (std::ranges::any_of(table.columns[column], number)) return false;
    table.cells[column] = kind;
  }
  value = date->seconds;
  table.zoneless_dates = table.zoneless_dates || (!date->zone && !date->time_only);
  return table.cells[column] == kind;
}

/// A unit as people write it, in the words of unit_factor; empty when it is none.
std::string known_unit(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 22> kOtherwise{
      {{"sec", "s"},      {"secs", "s"},        {"seconds", "s"},     {"µs", "us"},       {"degrees", "deg"},
       {"degree", "deg"}, {"°", "deg"},         {"°/s", "deg/s"},     {"radians", "rad"}, {"meters", "m"},
       {"metres", "m"},   {"m/s2", "m/s^2"},    {"m/s²", "m/s^2"},    {"m s-1", "m/s"},   {"m.s-1", "m/s"},
       {"m/sec", "m/s"},  {"rad/sec", "rad/s"}, {"deg/sec", "deg/s"}, {"knots", "kn"},    {"kts", "kn"},
       {"volts", "V"},    {"N·m", "N m"}}};
  for (const auto& [theirs, ours] : kOtherwise) {
    if (text == theirs) return std::string(ours);
  }
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (std::ranges::none_of(text, letter)) return {};  // "f(1)"
  for (const char* dimension : {"s", "m", "rad", "m/s", "rad/s", "m/s^2", "N", "N m", "V", "A", "Pa", "C", "W", "Hz"}) {
    try {
      static_cast<void>(unit_factor(text, dimension));
      return std::string(text);
    } catch (const InputError&) {  // another dimension, or no unit
    }
  }
  return {};
}

}  // namespace

NameAndUnit part_unit(std::string_view header) {
  const auto plain = [&] { return NameAndUnit{std::string(header), ""}; };
  if (header.size() < 4 || (header.back() != ']' && header.back() != ')')) return plain();
  const auto open = header.rfind(header.back() == ']' ? '[' : '(');
  if (open == std::string_view::npos || open == 0) return plain();
  const std::string unit = known_unit(trim(header.substr(open + 1, header.size() - open - 2)));
  if (unit.empty()) return plain();
  return {std::string(trim(header.substr(0, open))), unit};
}

const std::vector<double>* CsvTable::find(std::string_view name) const {
  auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) found = std::find(names.begin(), names.end(), part_unit(name).name);
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
  std::size_t number = 0, comment_number = 0;
  std::string_view comment;  // the last one: "% t, u, v" is a header where the next line holds numbers
  char separator = ',';
  while (!text.empty()) {
    std::string_view line = take_line(text);
    ++number;
    if (trim(line).empty()) continue;
    if (is_comment(trim(line))) {
      if (table.names.empty()) {
        comment = trim(line);
        while (!comment.empty() && is_comment(comment)) comment.remove_prefix(1);
        comment_number = number;
      }
      continue;
    }
    if (table.names.empty()) {
      const std::string here = path + ":" + std::to_string(number);
      separator = separator_of(line, here);
      const bool headless = holds_numbers(line, separator);
      if (headless && count_cells(comment, separator) == count_cells(line, separator) && !comment.empty()) {
        read_names(comment, separator, path + ":" + std::to_string(comment_number), table);
      } else if (headless && count_cells(line, separator) > 1) {
        throw InputError(here +
                         ": the first line holds numbers where the names of the columns belong; write them above");
      } else {
        read_names(line, separator, here, table);
      }
      for (auto& column : table.columns) column.reserve(expected_rows);
      table.lines.reserve(expected_rows);
      if (!headless) continue;
    }
    std::size_t cells = 0;
    for (bool more = true; more; ++cells) {
      const std::string_view cell = take_cell(line, separator, more);
      if (cells >= table.columns.size()) continue;
      double value{};
      std::string& fault = table.faults[cells];
      if (!read_number(cell, separator, value) && !read_date_cell(cell, cells, table, value) && fault.empty()) {
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
