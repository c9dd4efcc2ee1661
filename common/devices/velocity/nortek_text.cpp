#include "common/devices/velocity/nortek_text.hpp"

#include <charconv>

#include "common/devices/velocity/nortek_status.hpp"

namespace fathom::devices {
namespace {

// Of the formats 356 to 359; the first eleven of 356 and 357.
constexpr std::array kNames{"TIME", "DT1", "DT2", "VX",   "VY", "VZ",    "FOM",  "D1",
                            "D2",   "D3",  "D4",  "BATT", "SS", "PRESS", "TEMP", "STAT"};
constexpr std::size_t kShort = 11, kLong = 16, kMerit = 6, kStatus = 15;

std::optional<std::uint32_t> hexadecimal(std::string_view text) {
  if (!text.starts_with("0x") || text.size() != 10) return {};
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), value, 16);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

NortekText::NortekText(const Settings& settings) : NmeaParser{settings.checksum_required}, R_BS_{settings.R_BS} {}

std::optional<double> NortekText::value(std::size_t i) const { return number(told_[i]); }

// False when a value is missing or does not bear the name of its place.
bool NortekText::read(const Words& words) {
  const bool longer = words[0] == "PNORBT8" || words[0] == "PNORBT9";
  const bool named = words[0] == "PNORBT6" || words[0] == "PNORBT8";
  const std::size_t count = longer ? kLong : kShort;
  if (words.size() != count + 1) return false;
  for (std::size_t i = 0; i < count; ++i) {
    std::string_view word = words[i + 1];
    if (named) {
      const std::string_view name = kNames[i];
      if (!word.starts_with(name) || word.size() == name.size() || word[name.size()] != '=') return false;
      word.remove_prefix(name.size() + 1);
    }
    told_[i] = word;
  }
  if (!longer) return true;
  status_ = hexadecimal(told_[kStatus]);
  return status_.has_value();
}

void NortekText::sentence(const Words& words, Frame& frame) {
  told_ = {};
  status_.reset();
  const std::string_view id = words[0];
  if (id.size() != 7 || !id.starts_with("PNORBT")) return;
  if (id[6] < '6' || id[6] > '9') {
    frame.lacks = "one beam, or speed and course alone: no velocity in three axes";
    return complain("the log sends " + std::string{id} +
                    ", which holds no velocity in three axes; choose data format 356, 357, 358 or 359 ($PNORBT6 to 9)");
  }
  if (!read(words)) {
    told_ = {};
    frame.lacks = "values are missing or stand in another order";
    return;
  }
  complain("");
  frame.device_time = value(0);
  NortekReport report{
      .horizontal = {value(3), value(4)}, .vertical = {value(5), std::nullopt}, .distance = {}, .status = status_};
  if (status_ && (*status_ >> 14 & 3U) != 0) report.status = *status_ | 1U << 14;  // VZ is of either pair of beams
  for (std::size_t i = 0; i < 4; ++i) report.distance[i] = value(7 + i).value_or(0.0);
  if (!(value(kMerit).value_or(kNortekNoMerit) < kNortekNoMerit)) report.horizontal = {};
  sample_ = nortek_sample(report, R_BS_);
  frame.sample = &sample_;
}

void NortekText::describe_values(Fields& fields) const {
  constexpr std::array kColumns{"time_s",  "dt1_ms",       "dt2_ms", "vx_mps", "vy_mps", "vz_mps",
                                "fom_mps", "d1_m",         "d2_m",   "d3_m",   "d4_m",   "battery_v",
                                "sos_mps", "pressure_bar", "temp_c", "status"};
  for (std::size_t i = 0; i < kValues; ++i) fields.add(kColumns[i], told_[i]);
}

}  // namespace fathom::devices
