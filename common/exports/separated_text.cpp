#include "common/exports/separated_text.hpp"

#include <utility>

#include "common/base/error.hpp"

namespace fathom::exports {
namespace {

constexpr std::size_t kLongest = std::size_t{1} << 24U;  // bytes of a record: beyond, some quote is not closed
constexpr int kEnd = std::char_traits<char>::eof();

}  // namespace

SeparatedText::SeparatedText(std::string path) : path_{std::move(path)}, file_{path_, std::ios::binary} {
  if (!file_) throw InputError(path_ + ": cannot read this file");
}

bool SeparatedText::next(std::vector<std::string>& cells) {
  std::streambuf& bytes = *file_.rdbuf();
  while (bytes.sgetc() == '\n' || bytes.sgetc() == '\r') lines_ += bytes.sbumpc() == '\n' ? 1 : 0;
  if (bytes.sgetc() == kEnd) return false;
  line_ = lines_;
  std::size_t cell = 0, length = 0;
  const auto begin = [&] {
    if (cell == cells.size()) cells.emplace_back();
    cells[cell].clear();
  };
  begin();
  bool quoted = false;
  for (int c = bytes.sbumpc(); c != kEnd; c = bytes.sbumpc()) {
    if (++length > kLongest || (quoted && bytes.sgetc() == kEnd && c != '"'))
      throw InputError(path_ + ":" + std::to_string(line_) + ": a quote that begins here is not closed");
    lines_ += c == '\n' ? 1 : 0;
    if (c == '"' && quoted && bytes.sgetc() == '"') {
      cells[cell] += static_cast<char>(bytes.sbumpc());
    } else if (c == '"' && (quoted || cells[cell].empty())) {
      quoted = !quoted;
    } else if (quoted) {
      cells[cell] += static_cast<char>(c);
    } else if (c == ',') {
      ++cell;
      begin();
    } else if (c == '\n') {
      break;
    } else if (c != '\r') {
      cells[cell] += static_cast<char>(c);
    }
  }
  cells.resize(cell + 1);
  return true;
}

}  // namespace fathom::exports
