#include "common/devices/velocity/water_linked_serial.hpp"

#include <algorithm>
#include <array>

#include "common/devices/checksum.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 512;

}  // namespace

WaterLinkedSerial::WaterLinkedSerial(const Settings& settings) : Parser{kLongest}, R_BS_{settings.R_BS} {}

Parser::Look WaterLinkedSerial::look(Bytes bytes) const {
  if (bytes[0] != 'w') return skip_to(bytes, 'w');
  if (bytes.size() > 1 && bytes[1] != 'r' && bytes[1] != 'c') return skip(1);
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongest)));
  const std::size_t end = text.find_first_of("\r\n", 1);
  if (end == std::string_view::npos) return text.size() < kLongest ? kMore : kBadFrame;
  if (end < 6 || text[end - 3] != '*') return kBadFrame;
  const auto stated = hex_byte(text.substr(end - 2, 2));
  if (!stated || !checksum_right(*stated, crc8(bytes.first(end - 3)))) return kBadChecksum;
  return whole_frame(end + 1);
}

void WaterLinkedSerial::velocity(Frame& frame, std::size_t first, std::string_view valid, std::string_view altitude) {
  const auto x = words_.number_at(first);
  const auto y = words_.number_at(first + 1);
  const auto z = words_.number_at(first + 2);
  sample_ = Dvl{.altitude = std::max(0.0, number(altitude).value_or(0.0)), .valid = valid == "y" && x && y && z};
  if (sample_.valid) sample_.v_WB_B = R_BS_ * Eigen::Vector3d{*x, *y, *z};
  frame.sample = &sample_;
}

void WaterLinkedSerial::take(Frame& frame) {
  const std::string_view text = as_text(frame.bytes);
  words_ = Words{text.substr(0, text.rfind('*')), ','};
  if (words_[0] == "wrz") {
    new_protocol_ = true;
    velocity(frame, 1, words_[4], words_[5]);
    if (const auto microseconds = whole(words_[8])) frame.device_time = 1e-6 * static_cast<double>(*microseconds);
  } else if (words_[0] == "wrx" && !new_protocol_) {
    velocity(frame, 2, words_[7], words_[6]);
  } else if (words_[0] == "wr!") {
    complain("the instrument says that a command reached it damaged; look at the line to it");
  } else if (words_[0] == "wr?") {
    complain("the instrument does not know a command; is its firmware older than protocol 2?");
  }
}

void WaterLinkedSerial::describe(Fields& fields) const {
  fields.add("kind", words_[0]);
  constexpr std::array kNames{"f1", "f2", "f3", "f4", "f5", "f6", "f7", "f8", "f9", "f10", "f11", "f12"};
  for (std::size_t i = 0; i < kNames.size(); ++i) fields.add(kNames[i], words_[i + 1]);
}

}  // namespace fathom::devices
