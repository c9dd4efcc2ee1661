#include "common/devices/acoustics/evologics.hpp"

#include <algorithm>
#include <array>

#include "common/devices/positions.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kMostText = 512;
constexpr std::string_view kSign = "+++AT:";
constexpr std::size_t kLongest = kMostText + 16;
constexpr std::string_view kName = "USBLLONG";
constexpr std::size_t kLong = 17;  // its words

}  // namespace

Evologics::Evologics(const Settings& settings)
    : Parser{kLongest}, from_{settings.transceiver}, wanted_{settings.transceiver.beacon} {}

Parser::Look Evologics::look(Bytes bytes) const {
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongest)));
  if (text[0] == '+') return look_at_wrapped(text);
  if (text[0] == kName[0] && !wrapped_) return look_at_line(text);
  const std::size_t next = text.find_first_of(wrapped_ ? "+" : "+U", 1);
  return skip(next == std::string_view::npos ? text.size() : next);
}

Parser::Look Evologics::look_at_wrapped(std::string_view text) const {
  if (!kSign.starts_with(text.substr(0, kSign.size()))) return skip(1);
  wrapped_ = wrapped_ || text.starts_with(kSign);
  const std::size_t colon = text.find(':', kSign.size());
  if (colon == std::string_view::npos) return text.size() < kSign.size() + 5 ? kMore : kBadFrame;
  const auto size = whole(text.substr(kSign.size(), colon - kSign.size()));
  if (!size || static_cast<std::size_t>(*size) > kMostText) return kBadFrame;
  const std::size_t end = colon + 1 + static_cast<std::size_t>(*size);
  if (text.size() < end + 1) return kMore;
  const bool fits = text[end] == '\r' || text[end] == '\n';
  const bool inside = text.substr(colon + 1, end - colon - 1).find_first_of("\r\n") == std::string_view::npos;
  return fits && inside ? whole_frame(end + 1) : kBadFrame;
}

Parser::Look Evologics::look_at_line(std::string_view text) {
  if (!kName.starts_with(text.substr(0, kName.size()))) return skip(1);
  const std::size_t end = text.find_first_of("\r\n");
  if (end == std::string_view::npos) return text.size() < kMostText ? kMore : kBadFrame;
  const Words words{text.substr(0, end), ','};
  if (words.size() != kLong || words[0] != kName) return kBadFrame;
  for (std::size_t i = 1; i < kLong; ++i) {
    if (!words.number_at(i)) return kBadFrame;
  }
  return whole_frame(end + 1);
}

void Evologics::take(Frame& frame) {
  const std::string_view text = as_text(frame.bytes.first(frame.bytes.size() - 1));
  words_ = Words{text[0] == '+' ? text.substr(text.find(':', kSign.size()) + 1) : text, ','};
  if (words_[0] != kName) return;
  frame.lacks = "a word is missing";
  if (words_.size() != kLong) return;
  frame.device_time = words_.number_at(2);
  const auto east = words_.number_at(7);
  const auto north = words_.number_at(8);
  const auto up = words_.number_at(9);
  frame.lacks = "east, north or up is no number";
  if (!east || !north || !up) return;
  frame.lacks = "a fix of another modem";
  if (!wanted_.is(words_[3])) return complain(wanted_.complaint());
  complain("");
  const double accuracy = words_.number_at(16).value_or(0.0);
  sample_ = Usbl{.p_WB = from_north_up(*north, *east, -*up, from_),
                 .sigma = Eigen::Vector3d::Constant(accuracy > 0.0 ? accuracy : from_.sigma)};
  frame.sample = &sample_;
}

void Evologics::describe(Fields& fields) const {
  constexpr std::array kNames{"notification", "current_s", "measured_s", "address",   "x_m",       "y_m",
                              "z_m",          "east_m",    "north_m",    "up_m",      "roll_rad",  "pitch_rad",
                              "yaw_rad",      "travel_us", "rssi",       "integrity", "accuracy_m"};
  for (std::size_t i = 0; i < kNames.size(); ++i) fields.add(kNames[i], words_[i]);
}

}  // namespace fathom::devices
