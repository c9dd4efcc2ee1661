#include "common/devices/nmea_depth.hpp"

namespace fathom::devices {
namespace {

constexpr double kFoot = 0.3048;    // m
constexpr double kFathom = 1.8288;  // m
constexpr double kPascal = 1e4;     // Pa in a decibar

// metres, or feet or fathoms where these are empty
std::optional<double> below(const Words& words) {
  if (words[4] == "M" && words.number_at(3)) return words.number_at(3);
  if (words[2] == "f" && words.number_at(1)) return *words.number_at(1) * kFoot;
  if (words[6] == "F" && words.number_at(5)) return *words.number_at(5) * kFathom;
  return {};
}

}  // namespace

NmeaDepth::NmeaDepth(const Settings& settings)
    : NmeaParser{settings.checksum_required},
      air_pressure_{settings.air_pressure},
      per_metre_{settings.water_density * settings.gravity},
      absolute_{settings.pressure_is_absolute} {}

void NmeaDepth::read_prvat(const Words& words) {
  if (words[2] == "M") altitude_m_ = words.number_at(1);
  if (words[4] == "Metres") depth_m_ = words.number_at(3);
  if (words[4] == "dBar") pressure_dbar_ = words.number_at(3);
}

void NmeaDepth::sentence(const Words& words, Frame& frame) {
  depth_m_ = offset_m_ = altitude_m_ = pressure_dbar_ = std::nullopt;
  const std::string_view id = words[0];
  std::optional<double> z;
  const bool nmea =
      id.size() == 5 && (id.ends_with("DPT") || id.ends_with("DBT") || id.ends_with("DBS") || id.ends_with("DBK"));
  if (id == "PRVAT" || nmea) frame.lacks = "depth field empty";
  if (id == "PRVAT") {
    read_prvat(words);
    if (depth_m_) z = depth_m_;
    if (pressure_dbar_) z = (*pressure_dbar_ * kPascal - (absolute_ ? air_pressure_ : 0.0)) / per_metre_;
  } else if (id.size() == 5 && id.ends_with("DPT")) {
    depth_m_ = words.number_at(1);
    offset_m_ = words.number_at(2);
    if (depth_m_) z = *depth_m_ + (offset_m_ && *offset_m_ > 0.0 ? *offset_m_ : 0.0);
  } else if (id.size() == 5 && (id.ends_with("DBT") || id.ends_with("DBS") || id.ends_with("DBK"))) {
    depth_m_ = below(words);
    z = depth_m_;
  }
  if (!z) return;
  sample_ = Depth{.z = *z};
  frame.sample = &sample_;
}

void NmeaDepth::describe_values(Fields& fields) const {
  fields.add("depth_m", depth_m_);
  fields.add("offset_m", offset_m_);
  fields.add("altitude_m", altitude_m_);
  fields.add("pressure_dbar", pressure_dbar_);
}

}  // namespace fathom::devices
