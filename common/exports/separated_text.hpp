// Separated text with quotes, as RFC 4180 has it: record by record, a quoted cell may hold separators and ends of
// lines.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace fathom::exports {

class SeparatedText {
 public:
  /// InputError when the file cannot be read.
  explicit SeparatedText(std::string path);
  /// The cells of the next record, quotes removed; false at the end. InputError for a quote that is not closed.
  bool next(std::vector<std::string>& cells);
  /// In which the record begins that came last, 1 the first.
  [[nodiscard]] std::uint64_t line() const { return line_; }

 private:
  std::string path_;
  std::ifstream file_;
  std::uint64_t line_{}, lines_{1};
};

}  // namespace fathom::exports
