#include "common/devices/nmea.hpp"

#include <algorithm>
#include <array>

#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 512;  // the standard says 82; makers do not heed it

// Body between '$' and '*', and what stands behind the '*'.
struct Sentence {
  std::string_view body;
  std::string_view check;
  bool star{};
};

Sentence cut(std::string_view line) {
  line.remove_prefix(1);
  const std::size_t star = line.rfind('*');
  if (star == std::string_view::npos) return {line, {}, false};
  return {line.substr(0, star), line.substr(star + 1), true};
}

bool printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

}  // namespace

NmeaParser::NmeaParser(bool checksum_required) : Parser{kLongest}, checksum_required_{checksum_required} {}

Parser::Look NmeaParser::look(Bytes bytes) const {
  if (bytes[0] != '$') return skip_to(bytes, '$');
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongest)));
  const std::size_t end = text.find_first_of("\r\n$", 1);
  if (end == std::string_view::npos) return text.size() < kLongest ? kMore : kBadFrame;
  if (text[end] == '$') return kBadFrame;  // the line broke off and another began
  const Sentence sentence = cut(text.substr(0, end));
  if (sentence.check.empty()) {
    const bool good = !checksum_required_ && printable(sentence.body) && sentence.body.size() > 5;
    return good ? whole_frame(end + 1) : kBadChecksum;
  }
  const auto stated = hex_byte(sentence.check);
  if (!stated || !checksum_right(*stated, xor8(as_bytes(sentence.body)))) return kBadChecksum;
  return printable(sentence.body) ? whole_frame(end + 1) : kBadFrame;
}

void NmeaParser::take(Frame& frame) {
  const std::string_view text = as_text(frame.bytes);
  const Sentence parts = cut(text.substr(0, text.find_first_of("\r\n")));
  body_ = parts.body;
  checksum_ = parts.check.empty() ? Checksum::kAbsent : Checksum::kRight;
  frame.lacks = "a sentence that this protocol does not read";
  sentence(Words{body_, ','}, frame);
}

void NmeaParser::describe(Fields& fields) const {
  const std::size_t comma = std::min(body_.find(','), body_.size());
  fields.add("id", body_.substr(0, comma));
  fields.add("checksum", checksum_ == Checksum::kRight ? "ok" : "absent");
  std::array<char, kLongest> raw{};
  const std::string_view rest = body_.substr(std::min(comma + 1, body_.size()));
  std::replace_copy(rest.begin(), rest.end(), raw.begin(), ',', ';');
  fields.add("fields", std::string_view{raw.data(), rest.size()});
  describe_values(fields);
}

}  // namespace fathom::devices
