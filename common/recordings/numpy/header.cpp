#include "common/recordings/numpy/header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace fathom::recordings::numpy {
namespace {

/// Takes the text apart from the left; once something is not as expected all fails.
class Text {
 public:
  explicit Text(std::string_view text) : text_(text) {}

  void blanks() {
    while (!text_.empty() && std::isspace(static_cast<unsigned char>(text_.front())) != 0) text_.remove_prefix(1);
  }
  bool take(char c) {
    blanks();
    if (text_.empty() || text_.front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  [[nodiscard]] char next() {
    blanks();
    return text_.empty() ? '\0' : text_.front();
  }
  bool word(std::string& out) {
    const char quote = next();
    if (quote != '\'' && quote != '"') return false;
    const std::size_t end = text_.find(quote, 1);
    if (end == std::string_view::npos) return false;
    out = text_.substr(1, end - 1);
    text_.remove_prefix(end + 1);
    return true;
  }
  bool truth(bool& out) {
    blanks();
    for (const auto& [name, value] : {std::pair{std::string_view{"True"}, true}, {std::string_view{"False"}, false}}) {
      if (!text_.starts_with(name)) continue;
      text_.remove_prefix(name.size());
      out = value;
      return true;
    }
    return false;
  }
  bool whole(std::size_t& out) {
    blanks();
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), out);
    if (error != std::errc{}) return false;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    (void)take('L');  // of Python 2
    return true;
  }
  bool sizes(std::vector<std::size_t>& out) {
    if (!take('(')) return false;
    while (!take(')')) {
      std::size_t side = 0;
      if (!whole(side)) return false;
      out.push_back(side);
      if (!take(',') && next() != ')') return false;
    }
    return true;
  }

 private:
  std::string_view text_;
};

bool member_of(std::string_view type, Member& member) {
  if (type.size() < 2) return false;
  const char order = type[0];
  if (order != '<' && order != '>' && order != '|' && order != '=') return false;
  member.big = order == '>';
  member.kind = type[1];
  if (member.kind == 'O') {  // a pointer to what only Python understands
    member.size = 8;
    return true;
  }
  const char* begin = type.data() + 2;
  const auto [end, error] = std::from_chars(begin, type.data() + type.size(), member.size);
  if (error != std::errc{} || member.size > (1U << 20U)) return false;
  const std::string_view unit = type.substr(static_cast<std::size_t>(end - type.data()));
  if (member.kind == 'U') member.size *= 4;
  if (member.kind == 'M') {
    constexpr std::array<std::pair<std::string_view, double>, 7> kUnits{{{"[ns]", 1e-9},
                                                                         {"[us]", 1e-6},
                                                                         {"[ms]", 1e-3},
                                                                         {"[s]", 1.0},
                                                                         {"[m]", 60.0},
                                                                         {"[h]", 3600.0},
                                                                         {"[D]", 86400.0}}};
    const auto known = std::ranges::find(kUnits, unit, &std::pair<std::string_view, double>::first);
    member.to_seconds = known == kUnits.end() ? 0.0 : known->second;
  } else if (!unit.empty()) {
    return false;
  }
  return true;
}

bool members_of(Text& text, Header& header, std::string& reason) {
  std::string type;
  if (text.word(type)) {
    Member member;
    if (!member_of(type, member)) {
      reason = "its type '" + type + "' is not known";
      return false;
    }
    header.element = member.size;
    header.members.push_back(member);
    return true;
  }
  if (!text.take('[')) return false;
  while (!text.take(']')) {
    Member member;
    std::vector<std::size_t> inner;
    if (!text.take('(') || !text.word(member.name) || !text.take(',') || !text.word(type) || !member_of(type, member)) {
      reason = "its structure is nested, or has a type that is not known";
      return false;
    }
    if (text.take(',') && text.next() != ')' && !text.sizes(inner)) return false;
    if (!text.take(')')) return false;
    member.offset = header.element;
    std::size_t count = 1;
    for (const std::size_t side : inner) count = std::min<std::size_t>(count * side, 1U << 16U);
    header.element += member.size * count;
    if (inner.empty()) {
      header.members.push_back(member);
    } else {
      for (std::size_t i = 0; i < std::min<std::size_t>(count, 64); ++i) {
        Member one = member;
        one.name += "[" + std::to_string(i) + "]";
        one.offset += i * member.size;
        header.members.push_back(one);
      }
    }
    if (header.element > (1U << 24U)) return false;
    (void)text.take(',');
  }
  return !header.members.empty();
}

}  // namespace

std::optional<Header> header_of(std::string_view all, std::string& reason) {
  Text text{all};
  Header header;
  bool described = false, shaped = false;
  reason = "its header is not understood";
  if (!text.take('{')) return std::nullopt;
  while (!text.take('}')) {
    std::string key;
    if (!text.word(key) || !text.take(':')) return std::nullopt;
    if (key == "descr") {
      if (!members_of(text, header, reason)) return std::nullopt;
      described = true;
    } else if (key == "fortran_order") {
      if (!text.truth(header.fortran)) return std::nullopt;
    } else if (key == "shape") {
      if (!text.sizes(header.shape)) return std::nullopt;
      shaped = true;
    } else {
      return std::nullopt;
    }
    (void)text.take(',');
  }
  if (!described || !shaped) return std::nullopt;
  return header;
}

}  // namespace fathom::recordings::numpy
