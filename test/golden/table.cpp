#include "test/golden/table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>

namespace fathom::test {
namespace {

constexpr std::size_t kNamed = 5;  // rows that are there in one table only: so many are named, the rest counted

std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') return {};
  return number;
}

/// Difference as a share of `scale`; 0 for the same word, not-a-number or infinity in both, infinite for other words.
double move(const std::string& from, const std::string& to, double scale) {
  if (from == to) return 0.0;
  const auto a = number_in(from), b = number_in(to);
  if (!a || !b || !std::isfinite(*a) || !std::isfinite(*b)) return HUGE_VAL;
  return *a == *b ? 0.0 : std::abs(*b - *a) / scale;
}

double largest(const Table& table, std::size_t column) {
  double most = 0.0;
  for (const auto& row : table.rows) {
    const auto number = number_in(row[column]);
    if (number && std::isfinite(*number)) most = std::max(most, std::abs(*number));
  }
  return most;
}

void name_missing(const Table& in, const Table& from, const char* what, std::vector<std::string>& lines) {
  std::vector<std::string> missing;
  for (const auto& row : in.rows) {
    if (std::ranges::none_of(from.rows, [&](const auto& other) { return other[0] == row[0]; }))
      missing.push_back(row[0]);
  }
  if (missing.empty()) return;
  std::string line = std::to_string(missing.size()) + " rows are " + what + ":";
  for (std::size_t i = 0; i < std::min(missing.size(), kNamed); ++i) line += (i == 0 ? " " : ", ") + missing[i];
  lines.push_back(line + (missing.size() > kNamed ? ", ..." : ""));
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

/// A cell holds neither commas nor line ends: in words they stand for nothing that matters here.
std::string plain(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == ',' || c == '\n' || c == '\r'; }, ';');
  return text;
}

}  // namespace

std::string cell(double number) {
  if (std::isnan(number)) return "nan";
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

std::vector<std::string> moved(const Table& golden, const Table& now, double tolerance, Of of) {
  std::vector<std::string> lines;
  if (golden.columns != now.columns) {
    lines.emplace_back("the columns are others");
    return lines;
  }
  name_missing(golden, now, "gone", lines);
  name_missing(now, golden, "new", lines);
  std::map<std::string, std::vector<const std::vector<std::string>*>> by_name;
  for (const auto& row : now.rows) by_name[row[0]].push_back(&row);
  for (std::size_t c = 1; c < golden.columns.size(); ++c) {
    const double scale = largest(golden, c);
    double most = 0.0;
    std::size_t count = 0;
    const std::vector<std::string>*from = nullptr, *to = nullptr;
    std::map<std::string, std::size_t> used;  // rows of one name are compared in their order
    for (const auto& row : golden.rows) {
      const auto found = by_name.find(row[0]);
      const std::size_t which = used[row[0]]++;
      if (found == by_name.end() || which >= found->second.size()) continue;
      const auto& other = *found->second[which];
      const auto own = number_in(row[c]);
      const double size = of == Of::kColumn ? scale : (own ? std::abs(*own) : 0.0);
      const double by = move(row[c], other[c], size);
      if (!(by > tolerance)) continue;
      ++count;
      if (from != nullptr && by <= most) continue;
      most = by;
      from = &row;
      to = &other;
    }
    if (from == nullptr) continue;
    char share[64] = "";
    if (std::isfinite(most))
      std::snprintf(share, sizeof share, ", by %.3g of %s", most,
                    of == Of::kColumn ? "the column's largest" : "itself");
    lines.push_back(golden.columns[c] + ": " + std::to_string(count) + " of " + std::to_string(golden.rows.size()) +
                    " moved, most at " + (*from)[0] + " from " + (*from)[c] + " to " + (*to)[c] + share);
  }
  if (lines.empty() && golden.rows.size() != now.rows.size()) lines.emplace_back("the number of rows is another");
  return lines;
}

Table read_table(const std::string& path) {
  std::ifstream file{path};
  if (!file) throw std::runtime_error(path + ": cannot be read; ./check --golden --renew makes it");
  Table table;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    auto cells = cells_of(line);
    if (table.columns.empty()) {
      table.columns = std::move(cells);
    } else if (cells.size() == table.columns.size()) {
      table.rows.push_back(std::move(cells));
    } else {
      throw std::runtime_error(path + ": a row is not as long as the header: " + line);
    }
  }
  return table;
}

void write_table(const std::string& path, const Table& table, const std::string& comment) {
  std::ofstream file{path};
  file << "# " << comment << "\n";
  const auto write = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) file << (i > 0 ? "," : "") << plain(cells[i]);
    file << "\n";
  };
  write(table.columns);
  for (const auto& row : table.rows) write(row);
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

void check_golden(const std::string& name, const Table& now, double tolerance, Of of) {
  const std::string path = std::string{FATHOM_SOURCE_DIR} + "/test/golden/" + name + ".csv";
  REQUIRE_FALSE(now.rows.empty());
  Table as_written = now;
  for (auto& row : as_written.rows) {
    for (std::string& text : row) text = plain(text);
  }
  const bool renew = std::getenv("FATHOM_GOLDEN_RENEW") != nullptr;
  std::vector<std::string> lines;
  if (renew && !std::filesystem::exists(path)) {
    lines.emplace_back("new");
  } else {
    lines = moved(read_table(path), as_written, tolerance, of);
  }
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  if (!renew) {
    CHECK_MESSAGE(lines.empty(), name << ".csv: intended? ./check --golden --renew" << text);
    return;
  }
  std::fprintf(stderr, "%s.csv: %s%s\n", name.c_str(), lines.empty() ? "as it was" : "renewed", text.c_str());
  if (lines.empty()) return;
  char comment[160];
  std::snprintf(comment, sizeof comment, "Made by ./check --golden --renew. Tolerance: %g of %s.", tolerance,
                of == Of::kColumn ? "a column's largest number" : "each number");
  write_table(path, now, comment);
}

}  // namespace fathom::test
