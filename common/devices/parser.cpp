#include "common/devices/parser.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <utility>

namespace fathom::devices {
namespace {

constexpr std::size_t kPiece = 4096;  // room for new bytes beside the longest frame
constexpr std::size_t kDigits = 64;

}  // namespace

void Fields::add(std::string_view name, double value) {
  std::array<char, kDigits> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  add(name, std::string_view{text.data(), static_cast<std::size_t>(end - text.data())});
}

void Fields::add(std::string_view name, float value) {
  std::array<char, kDigits> text{};  // nine digits give every float back
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9).ptr;
  add(name, std::string_view{text.data(), static_cast<std::size_t>(end - text.data())});
}

void Fields::add(std::string_view name, std::int64_t value) {
  std::array<char, kDigits> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  add(name, std::string_view{text.data(), static_cast<std::size_t>(end - text.data())});
}

void Fields::add_hex(std::string_view name, std::uint64_t value, int digits) {
  std::array<char, kDigits> text{};
  const auto width = static_cast<std::size_t>(digits);
  for (std::size_t i = 0; i < width; ++i) text[i] = "0123456789ABCDEF"[value >> 4 * (width - 1 - i) & 0xFU];
  add(name, std::string_view{text.data(), width});
}

void Fields::add_fixed(std::string_view name, double value, int decimals) {
  std::array<char, kDigits> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  add(name, std::string_view{text.data(), static_cast<std::size_t>(end - text.data())});
}

Parser::Parser(std::size_t longest) : longest_{longest}, buffer_(2 * longest + kPiece) {}

void Parser::feed(Bytes bytes, Output& output) {
  counters_.bytes += bytes.size();
  while (!bytes.empty()) {
    if (buffer_.size() - end_ < kPiece) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      end_ -= begin_;
      begin_ = 0;
    }
    const std::size_t count = std::min(bytes.size(), buffer_.size() - end_);
    std::memcpy(buffer_.data() + end_, bytes.data(), count);
    end_ += count;
    bytes = bytes.subspan(count);
    scan(output, false);
  }
}

void Parser::finish(Output& output) { scan(output, true); }

void Parser::restart() {
  counters_.skipped += end_ - begin_;
  offset_ += end_ - begin_;
  begin_ = end_ = 0;
  returned_ = false;
}

void Parser::scan(Output& output, bool ended) {
  std::uint64_t cut_off = 0;  // bytes skipped at the end since a frame began that wants more than there is
  bool waiting = false;
  while (begin_ < end_) {
    const Bytes rest{buffer_.data() + begin_, end_ - begin_};
    if (std::exchange(returned_, false) && rest[0] == '\n') {
      ++counters_.line_ends;
      ++begin_;
      ++offset_;
      continue;
    }
    Look seen = look(rest);
    if (seen.verdict == Look::Verdict::kMore) {
      if (!ended && rest.size() < longest_) return;
      waiting = waiting || ended;
      seen = skip(1);
    }
    if (seen.verdict == Look::Verdict::kBadChecksum) ++counters_.bad_checksum;
    if (seen.verdict == Look::Verdict::kBadFrame) ++counters_.bad_frame;
    if (seen.verdict == Look::Verdict::kFrame) {
      counters_.skipped += cut_off;
      cut_off = 0;
      waiting = false;
      Frame frame{.offset = offset_, .bytes = rest.first(seen.length)};
      ++counters_.frames;
      returned_ = frame.bytes.back() == '\r';
      take(frame);
      output.frame(*this, frame);
    } else {
      (waiting ? cut_off : counters_.skipped) += seen.length;
    }
    begin_ += seen.length;
    offset_ += seen.length;
  }
  counters_.incomplete += cut_off;
  begin_ = end_ = 0;
}

Parser::Look Parser::skip_to(Bytes bytes, std::uint8_t sync) {
  const void* found = std::memchr(bytes.data(), sync, bytes.size());
  if (found == nullptr) return skip(bytes.size());
  return skip(static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes.data()));
}

}  // namespace fathom::devices
