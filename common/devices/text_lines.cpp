#include "common/devices/text_lines.hpp"

#include <algorithm>

#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

bool ends_line(char c) { return c == '\r' || c == '\n'; }

}  // namespace

// A line that is refused is skipped as a whole: what its tail says means something else without its head.
Parser::Look TextLines::look(Bytes bytes) const {
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongestLine)));
  if (ends_line(text[0])) return skip(1);
  const std::size_t end = text.find_first_of("\r\n");
  if (end == std::string_view::npos) {
    return text.size() < kLongestLine ? kMore : Look{Look::Verdict::kBadFrame, text.size()};
  }
  if (!accepts(trim(text.substr(0, end)))) return {Look::Verdict::kBadFrame, end + 1};
  return whole_frame(end + 1);
}

void TextLines::take(Frame& frame) { line(trim(as_text(frame.bytes.first(frame.bytes.size() - 1))), frame); }

}  // namespace fathom::devices
