#include "common/recordings/ulog/layout.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "common/recordings/little.hpp"

namespace fathom::recordings::ulog {
namespace {

constexpr std::size_t kMostBytes = 65535;  // of a message
constexpr int kMostDepth = 16;

struct Basic {
  std::string_view name;
  char letter;
  std::size_t size;
};
constexpr std::array<Basic, 12> kBasics{{{"int8_t", 'b', 1},
                                         {"uint8_t", 'B', 1},
                                         {"int16_t", 'h', 2},
                                         {"uint16_t", 'H', 2},
                                         {"int32_t", 'i', 4},
                                         {"uint32_t", 'I', 4},
                                         {"int64_t", 'q', 8},
                                         {"uint64_t", 'Q', 8},
                                         {"float", 'f', 4},
                                         {"double", 'd', 8},
                                         {"bool", '?', 1},
                                         {"char", 'c', 1}}};

}  // namespace

bool Formats::add(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  const bool printable = std::ranges::all_of(text, [](unsigned char c) { return c >= ' ' && c < 127; });
  if (!printable) return false;
  std::vector<Member> members;
  std::string_view rest = text.substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string_view one = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t gap = one.find(' ');
    if (gap == std::string_view::npos || gap == 0) return false;
    Member member{.type = std::string{one.substr(0, gap)}, .name = std::string{one.substr(gap + 1)}};
    if (const std::size_t bracket = member.type.find('['); bracket != std::string::npos) {
      const char* begin = member.type.data() + bracket + 1;
      const auto [last, error] = std::from_chars(begin, member.type.data() + member.type.size(), member.count);
      if (error != std::errc{} || *last != ']' || member.count == 0 || member.count > kMostBytes) return false;
      member.list = true;
      member.type.resize(bracket);
    }
    members.push_back(std::move(member));
  }
  if (members.empty()) return false;
  formats_[std::string{text.substr(0, colon)}] = std::move(members);
  return true;
}

bool Formats::lay_out(const std::string& name, const std::string& path, int depth, Layout& layout) const {
  const auto found = formats_.find(name);
  if (found == formats_.end() || depth > kMostDepth) return false;
  for (const Member& member : found->second) {
    const auto basic = std::ranges::find(kBasics, member.type, &Basic::name);
    const std::string own = path + member.name;
    if (basic == kBasics.end()) {
      for (std::size_t i = 0; i < member.count; ++i) {
        const std::string at = own + (member.list ? "[" + std::to_string(i) + "]" : "") + ".";
        if (!lay_out(member.type, at, depth + 1, layout)) return false;
      }
      continue;
    }
    if (layout.size + basic->size * member.count > kMostBytes) return false;
    if (basic->letter == 'c') {
      layout.places.push_back({own, 'c', layout.size, member.count});
    } else if (!member.name.starts_with("_padding")) {
      for (std::size_t i = 0; i < member.count; ++i) {
        layout.places.push_back({own + (member.list ? "[" + std::to_string(i) + "]" : ""), basic->letter,
                                 layout.size + i * basic->size, 1});
      }
    }
    layout.size += basic->size * member.count;
    // Padding is not stored where it is the last of all.
    if (!member.name.starts_with("_padding")) layout.stored = layout.size;
  }
  return true;
}

std::optional<Layout> Formats::layout(const std::string& name) const {
  Layout layout;
  if (!lay_out(name, "", 0, layout)) return std::nullopt;
  return layout;
}

double number(const Place& place, Bytes message) {
  const std::size_t at = place.offset;
  switch (place.type) {
    case 'b':
      return little<std::int8_t>(message, at);
    case 'h':
      return little<std::int16_t>(message, at);
    case 'H':
      return little<std::uint16_t>(message, at);
    case 'i':
      return little<std::int32_t>(message, at);
    case 'I':
      return little<std::uint32_t>(message, at);
    case 'q':
      return static_cast<double>(little<std::int64_t>(message, at));
    case 'Q':
      return static_cast<double>(little<std::uint64_t>(message, at));
    case 'f':
      return static_cast<double>(little<float>(message, at));
    case 'd':
      return little<double>(message, at);
    default:
      return message[at];
  }
}

}  // namespace fathom::recordings::ulog
