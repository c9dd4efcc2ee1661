#include "common/devices/nmea_attitude.hpp"

#include "common/devices/attitude.hpp"

namespace fathom::devices {

NmeaAttitude::NmeaAttitude(const Settings& settings) : NmeaParser{settings.checksum_required}, R_BS_{settings.R_BS} {}

void NmeaAttitude::sentence(const Words& words, Frame& frame) {
  roll_deg_ = pitch_deg_ = heading_deg_ = heave_m_ = std::nullopt;
  const std::string_view id = words[0];
  constexpr std::size_t kWhole = 6;  // words; with fewer, one was lost, and the others stand in its place
  if (id == "PSXN" && words[1] == "23" && words.size() >= kWhole) {
    roll_deg_ = words.number_at(2);
    pitch_deg_ = words.number_at(3);
    heading_deg_ = words[4].empty() ? true_heading_deg_ : words.number_at(4);
    heave_m_ = words.number_at(5);
  } else if (id == "SBG01" && words.size() >= kWhole) {
    roll_deg_ = words.number_at(2);
    pitch_deg_ = words.number_at(3);
    heading_deg_ = words.number_at(4);
    heave_m_ = words.number_at(5);
    frame.device_time = time_of_day(words[1]);
  } else if (id.size() == 5 && id.ends_with("HDT")) {
    heading_deg_ = words.number_at(1);
    true_heading_deg_ = heading_deg_;
    return;
  }
  if (!roll_deg_ || !pitch_deg_ || !heading_deg_) return;
  sample_ = {};
  sample_.q_WB = body_attitude(Eigen::Vector3d{*roll_deg_, *pitch_deg_, *heading_deg_} * kRadians, R_BS_);
  sample_.has_attitude = true;
  frame.sample = &sample_;
}

void NmeaAttitude::describe_values(Fields& fields) const {
  fields.add("roll_deg", roll_deg_);
  fields.add("pitch_deg", pitch_deg_);
  fields.add("heading_deg", heading_deg_);
  fields.add("heave_m", heave_m_);
}

}  // namespace fathom::devices
