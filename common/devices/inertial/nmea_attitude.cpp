#include "common/devices/inertial/nmea_attitude.hpp"

#include <utility>

#include "common/devices/attitude.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kWhole = 6;       // words; with fewer, one was lost, and the others stand in its place
constexpr std::uint8_t kAligns = 0x02;  // of the lowest byte of iXblue's algorithm status

}  // namespace

NmeaAttitude::NmeaAttitude(const Settings& settings) : NmeaParser{settings.checksum_required}, R_BS_{settings.R_BS} {}

void NmeaAttitude::tell(double pitch_deg, Frame& frame) {
  sample_ = {};
  sample_.q_WB = body_attitude(Eigen::Vector3d{*roll_deg_, pitch_deg, *heading_deg_} * kRadians, R_BS_);
  sample_.has_attitude = true;
  frame.sample = &sample_;
}

void NmeaAttitude::read_heading(const Words& words, Frame& frame) {
  frame.lacks = {};
  // $--THS says whether it holds: A; estimated, simulated or not valid otherwise.
  const bool holds = !words[0].ends_with("THS") || words[2] == "A";
  heading_deg_ = words.number_at(1);
  true_heading_deg_ = block_heading_deg_ = holds ? heading_deg_ : std::nullopt;
  if (!heading_deg_) frame.lacks = "heading field empty";
  if (!holds) frame.lacks = "the heading is marked as not valid";
}

// Roll, pitch of a block whose heading came before; the status of the algorithm.
void NmeaAttitude::read_pixse(const Words& words, Frame& frame) {
  frame.lacks = {};
  if (words[1] == "ALGSTS") {
    const auto low = words[2].size() == 8 ? hex_byte(words[2].substr(6)) : std::nullopt;
    if (!low) return;
    aligning_ = (*low & kAligns) != 0;
    complain(aligning_ ? "the inertial system is aligning: its attitude is not used until it has ended" : "");
    return;
  }
  if (words[1] != "ATITUD") return;
  roll_deg_ = words.number_at(2);
  pitch_deg_ = words.number_at(3);
  heading_deg_ = std::exchange(block_heading_deg_, std::nullopt);
  if (words.size() != 4 || !roll_deg_ || !pitch_deg_) {
    frame.lacks = "roll or pitch field empty";
  } else if (!heading_deg_) {
    frame.lacks = "no heading ($HEHDT, $HETHS) since the roll and pitch before";
  } else if (aligning_) {
    frame.lacks = "the inertial system is aligning";
  } else {
    tell(-*pitch_deg_, frame);
  }
}

void NmeaAttitude::sentence(const Words& words, Frame& frame) {
  roll_deg_ = pitch_deg_ = heading_deg_ = heave_m_ = std::nullopt;
  const std::string_view id = words[0];
  if (id == "PSXN" && words[1] != "23") {
    frame.lacks = {};
    return;
  }
  if (id == "PSXN") {
    if (words.size() >= kWhole) {
      roll_deg_ = words.number_at(2);
      pitch_deg_ = words.number_at(3);
      heading_deg_ = words[4].empty() ? true_heading_deg_ : words.number_at(4);
      heave_m_ = words.number_at(5);
    }
  } else if (id == "SBG01") {
    if (words.size() >= kWhole) {
      roll_deg_ = words.number_at(2);
      pitch_deg_ = words.number_at(3);
      heading_deg_ = words.number_at(4);
      heave_m_ = words.number_at(5);
      frame.device_time = time_of_day(words[1]);
    }
  } else if (id == "PIXSE") {
    return read_pixse(words, frame);
  } else {
    if (id.size() == 5 && (id.ends_with("HDT") || id.ends_with("THS"))) read_heading(words, frame);
    return;
  }
  if (words.size() < kWhole) {
    frame.lacks = "a field is missing";
  } else if (!roll_deg_ || !pitch_deg_) {
    frame.lacks = "roll or pitch field empty";
  } else if (!heading_deg_) {
    frame.lacks = id == "PSXN" ? "heading field empty and no $--HDT before" : "heading field empty";
  } else {
    tell(*pitch_deg_, frame);
  }
}

void NmeaAttitude::describe_values(Fields& fields) const {
  fields.add("roll_deg", roll_deg_);
  fields.add("pitch_deg", pitch_deg_);
  fields.add("heading_deg", heading_deg_);
  fields.add("heave_m", heave_m_);
}

}  // namespace fathom::devices
