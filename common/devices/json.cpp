#include "common/devices/json.hpp"

#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

bool of_number(char c) { return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E'; }

}  // namespace

void JsonCursor::blanks() {
  while (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == '\n') ++at_;
}

bool JsonCursor::accept(char c) {
  blanks();
  if (!good_ || peek() != c || at_ >= text_.size()) return false;
  ++at_;
  return true;
}

bool JsonCursor::expect(char c) {
  if (!accept(c)) good_ = false;
  return good_;
}

bool JsonCursor::finished() {
  blanks();
  return good_ && at_ == text_.size();
}

std::string_view JsonCursor::string() {
  if (!expect('"')) return {};
  const std::size_t begin = at_;
  for (; at_ < text_.size(); ++at_) {
    const auto c = static_cast<unsigned char>(text_[at_]);
    if (c == '"') return text_.substr(begin, at_++ - begin);
    if (c < ' ') break;
    if (c == '\\') ++at_;
  }
  good_ = false;
  return {};
}

std::string_view JsonCursor::number_text() {
  blanks();
  const std::size_t begin = at_;
  while (of_number(peek())) ++at_;
  const std::string_view text = text_.substr(begin, at_ - begin);
  if (text.empty() || text[0] == '+' || !devices::number(text, true)) good_ = false;
  return text;
}

std::optional<double> JsonCursor::number() {
  blanks();
  if (!of_number(peek())) {
    skip();
    return {};
  }
  const std::string_view text = number_text();
  return good_ ? devices::number(text, true) : std::nullopt;
}

std::optional<bool> JsonCursor::boolean() {
  blanks();
  if (peek() == 't') return word("true") ? std::optional{true} : std::nullopt;
  if (peek() == 'f') return word("false") ? std::optional{false} : std::nullopt;
  skip();
  return {};
}

bool JsonCursor::word(std::string_view literal) {
  if (text_.substr(at_, literal.size()) != literal) {
    good_ = false;
    return false;
  }
  at_ += literal.size();
  return true;
}

void JsonCursor::skip() { skip(0); }

void JsonCursor::skip(int depth) {
  blanks();
  if (depth > kDeepest) good_ = false;
  if (!good_) return;
  switch (peek()) {
    case '{':
      return object([&](std::string_view) { skip(depth + 1); });
    case '[':
      return array([&](std::size_t) { skip(depth + 1); });
    case '"':
      string();
      return;
    case 't':
      word("true");
      return;
    case 'f':
      word("false");
      return;
    case 'n':
      word("null");
      return;
    default:
      number_text();
  }
}

}  // namespace fathom::devices
