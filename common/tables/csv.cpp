#include "common/tables/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/tables/date_text.hpp"
#include "common/tables/unit_words.hpp"

namespace fathom::tables {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kShownCell = 24;                 // characters of a bad cell that a message repeats
constexpr std::size_t kFirstBytes = 1024;              // that tell a text from what is none
constexpr std::size_t kPiece = std::size_t{1} << 20U;  // bytes of a file read at once

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
    if (name.empty() && headers.empty() && more) {  // the numbers of the rows, as data frames write them
      headers.emplace_back("(row)");
      continue;
    }
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

/// "05/06/2024": which of the two is the month depends on who wrote it.
bool has_two_dates(std::string_view cell) {
  std::size_t at = 0;
  const auto digits = [&](std::size_t most) {
    const std::size_t begin = at;
    while (at < cell.size() && at - begin < most && cell[at] >= '0' && cell[at] <= '9') ++at;
    return at - begin;
  };
  const auto stroke = [&] { return at < cell.size() && (cell[at] == '/' || cell[at] == '-') && ++at > 0; };
  return digits(2) > 0 && stroke() && digits(2) > 0 && stroke() && digits(4) == 4;
}

/// A table on its way in, line by line.
class Parser {
 public:
  /// `first`: the first bytes of the text. `rows`: how many lines there will be, about.
  Parser(const std::string& path, std::string_view first, std::size_t rows) : path_(path), expected_rows_(rows) {
    table_.path = path;
    check_text(first, path);
  }
  /// `last`: nothing stands behind it.
  void take(std::string_view line, bool last) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (number_++ == 0 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    if (trim(line).empty()) return;
    if (is_comment(trim(line))) {
      if (table_.names.empty()) keep_comment(trim(line));
    } else if (!table_.names.empty() || !read_header(line)) {
      read_row(line, last);
    }
  }
  CsvTable finish() {
    if (table_.names.empty()) throw InputError(path_ + ": the file is empty");
    if (table_.rows() == 0) throw InputError(path_ + ": there is a header but not one row of numbers");
    return std::move(table_);
  }

 private:
  void keep_comment(std::string_view comment) {
    while (!comment.empty() && is_comment(comment)) comment.remove_prefix(1);
    comment_ = comment;
    comment_number_ = number_;
  }
  /// False where the line holds numbers and a comment above them the names.
  bool read_header(std::string_view line) {
    const std::string here = path_ + ":" + std::to_string(number_);
    separator_ = separator_of(line, here);
    const bool headless = holds_numbers(line, separator_);
    if (headless && count_cells(comment_, separator_) == count_cells(line, separator_) && !comment_.empty()) {
      read_names(comment_, separator_, path_ + ":" + std::to_string(comment_number_), table_);
    } else if (headless && count_cells(line, separator_) > 1) {
      throw InputError(here + ": the first line holds numbers where the names of the columns belong; write them above");
    } else {
      read_names(line, separator_, here, table_);
    }
    for (auto& column : table_.columns) column.reserve(expected_rows_);
    table_.lines.reserve(expected_rows_);
    return !headless;
  }
  /// "s,m,rad": below the header of what archives and loggers write, no number in it and some unit. True where it was
  /// one.
  bool read_units(std::string_view line) {
    std::vector<std::string> units;
    bool any = false;
    for (bool more = true; more;) {
      const std::string_view cell = take_cell(line, separator_, more);
      double value{};
      if (!cell.empty() && !is_none(cell) && (read_number(cell, separator_, value) || read_date(cell))) return false;
      units.push_back(known_unit(cell));
      any = any || !units.back().empty();
    }
    if (!any || units.size() != table_.units.size()) return false;
    for (std::size_t i = 0; i < units.size(); ++i) {
      if (table_.units[i].empty()) table_.units[i] = units[i];
    }
    return true;
  }
  void read_row(std::string_view line, bool last) {
    if (table_.rows() == 0 && !std::exchange(below_header_, true) && read_units(line)) return;
    std::size_t cells = 0;
    for (bool more = true; more; ++cells) {
      const std::string_view cell = take_cell(line, separator_, more);
      if (cells >= table_.columns.size()) continue;
      if (cells == 0 && !cell.empty() && cell == table_.names.front())
        throw InputError(path_ + ":" + std::to_string(number_) +
                         ": the header stands here again: another table was joined to this one; part them");
      double value{};
      std::string& fault = table_.faults[cells];
      if (!read_number(cell, separator_, value) && !read_date_cell(cell, cells, table_, value) && fault.empty()) {
        fault = path_ + ":" + std::to_string(number_) + ": column '" + table_.names[cells] + "': '" +
                std::string(cell.substr(0, kShownCell)) + "'" +
                (has_two_dates(cell) ? " leaves open which is the day and which the month (write the year first, "
                                       "2024-06-05 10:00:00): it"
                                     : "") +
                " is not a number";
      }
      table_.columns[cells].push_back(value);
    }
    if (cells != table_.names.size()) {
      throw InputError(path_ + ":" + std::to_string(number_) + ": this row has " + std::to_string(cells) +
                       " cells, the header names " + std::to_string(table_.names.size()) +
                       (last ? " (was the file cut off?)" : ""));
    }
    table_.lines.push_back(number_);
  }

  const std::string& path_;
  std::size_t expected_rows_;
  CsvTable table_;
  std::size_t number_{}, comment_number_{};
  std::string comment_;  ///< the last one: "% t, u, v" is a header where the next line holds numbers
  char separator_{','};
  bool below_header_{};  ///< the line below the header was looked at
};

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

const Paged<double>* CsvTable::find(std::string_view name) const {
  auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) found = std::find(names.begin(), names.end(), part_unit(name).name);
  return found == names.end() ? nullptr : &columns[static_cast<std::size_t>(found - names.begin())];
}

std::string CsvTable::where(std::size_t row) const {
  return path + ":" + std::to_string(row < lines.size() ? lines[row] : 1);
}

CsvTable parse_csv(std::string_view text, const std::string& path) {
  Parser parser{path, text.substr(0, kFirstBytes), static_cast<std::size_t>(std::ranges::count(text, '\n'))};
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    parser.take(line, text.empty());
  }
  return parser.finish();
}

CsvTable read_csv(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) throw InputError(path + ": cannot read this file");
  std::string piece(kPiece, '\0');
  std::string first;
  std::size_t rows = 0;
  std::uintmax_t size = 0, taken = 0;
  const auto next = [&] {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    if (file.bad()) throw InputError(path + ": cannot read this file to its end");
    return std::string_view{piece.data(), static_cast<std::size_t>(file.gcount())};
  };
  for (std::string_view bytes = next(); !bytes.empty(); bytes = next()) {
    if (size == 0) first = bytes.substr(0, kFirstBytes);
    rows += static_cast<std::size_t>(std::ranges::count(bytes, '\n'));
    size += bytes.size();
  }
  Parser parser{path, first, rows};
  file.clear();
  file.seekg(0);
  std::string begun;  // a line of which only the beginning has been read
  for (std::string_view bytes = next(); !bytes.empty(); bytes = next()) {
    while (!bytes.empty()) {
      const bool whole = bytes.find('\n') != std::string_view::npos;
      const std::string_view line = take_line(bytes);
      taken += line.size() + (whole ? 1 : 0);
      const bool last = taken >= size;
      if (!whole && !last) {
        begun += line;
      } else if (begun.empty()) {
        parser.take(line, last);
      } else {
        parser.take(begun += line, last);
        begun.clear();
      }
    }
  }
  return parser.finish();
}

}  // namespace fathom::tables
