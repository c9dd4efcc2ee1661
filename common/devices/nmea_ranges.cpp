#include "common/devices/nmea_ranges.hpp"

#include <algorithm>

namespace fathom::devices {

NmeaRanges::NmeaRanges(const Settings& settings)
    : NmeaParser{settings.checksum_required},
      count_{settings.transponders.empty() ? kMost : std::min(settings.transponders.size(), kMost)},
      sound_speed_{settings.sound_speed} {
  sample_.range.resize(count_);
  sample_.valid.resize(count_);
}

void NmeaRanges::sentence(const Words& words, Frame& frame) {
  array_ = unit_ = {};
  time_ = roll_deg_ = pitch_deg_ = course_deg_ = depth_m_ = std::nullopt;
  told_ = {};
  if (words[0] != "PSIMLBM") return;
  frame.lacks = "the last field is neither M nor S";
  time_ = time_of_day(words[1]);
  array_ = words[2];
  roll_deg_ = words.number_at(4);
  pitch_deg_ = words.number_at(5);
  course_deg_ = words.number_at(6);
  depth_m_ = words.number_at(7);
  for (std::size_t i = 0; i < kMost; ++i) told_[i] = words.number_at(8 + i);
  unit_ = words[16];
  if (unit_ != "M" && unit_ != "S") return;
  const double scale = unit_ == "S" ? sound_speed_ : 1.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const bool valid = told_[i] && *told_[i] > 0.0;
    sample_.valid[i] = valid;
    sample_.range[i] = valid ? *told_[i] * scale : 0.0;
  }
  frame.device_time = time_;
  frame.sample = &sample_;
}

void NmeaRanges::describe_values(Fields& fields) const {
  fields.add("time_s", time_);
  fields.add("array", array_);
  fields.add("roll_deg", roll_deg_);
  fields.add("pitch_deg", pitch_deg_);
  fields.add("course_deg", course_deg_);
  fields.add("depth_m", depth_m_);
  constexpr std::array<const char*, kMost> kNames{"r1", "r2", "r3", "r4", "r5", "r6", "r7", "r8"};
  for (std::size_t i = 0; i < kMost; ++i) fields.add(kNames[i], told_[i]);
  fields.add("unit", unit_);
}

}  // namespace fathom::devices
