// The fields of a PD0 ensemble by name, in the instrument's units.
#include <array>
#include <cstdio>

#include "common/devices/velocity/pd0.hpp"

namespace fathom::devices {
namespace {

std::uint64_t sum(Bytes bytes) {
  std::uint64_t total = 0;
  for (const std::uint8_t byte : bytes) total += byte;
  return total;
}

}  // namespace

void Pd0::describe(Fields& fields) const {
  fields.add("length", little<std::uint16_t>(bytes_, 2));
  std::array<char, 5 * 256> names{};
  std::size_t end = 0;
  for (std::size_t i = 0; i < bytes_[5]; ++i) {
    const std::size_t at = little<std::uint16_t>(bytes_, 6 + 2 * i);
    if (at + 4 > bytes_.size()) continue;
    if (end > 0) names[end++] = ' ';
    for (int shift = 12; shift >= 0; shift -= 4) {
      names[end++] = "0123456789ABCDEF"[little<std::uint16_t>(bytes_, at) >> shift & 0xF];
    }
  }
  fields.add("ids", std::string_view{names.data(), end});
  describe_leaders(fields);
  describe_profile(fields);
  describe_bottom(fields);
}

void Pd0::describe_leaders(Fields& fields) const {
  const auto fixed = [&](const char* name, auto read) {
    fields.add(name, fixed_.empty() ? std::optional<std::int64_t>{} : std::optional<std::int64_t>{read(fixed_)});
  };
  const auto hundredths = [&](const char* name, Bytes block, std::size_t at, int decimals, bool with_sign) {
    if (block.empty()) return fields.add(name, "");
    const int value = with_sign ? little<std::int16_t>(block, at) : little<std::uint16_t>(block, at);
    fields.add_fixed(name, 0.01 * value, decimals);
  };
  if (fixed_.empty()) {
    for (const char* name : {"fw", "sysconfig", "freq_khz", "up", "beam_angle_deg"}) fields.add(name, "");
  } else {
    std::array<char, 16> text{};
    const int length = std::snprintf(text.data(), text.size(), "%u.%u", fixed_[2], fixed_[3]);
    fields.add("fw", std::string_view{text.data(), static_cast<std::size_t>(length)});
    const unsigned system = little<std::uint16_t>(fixed_, 4);
    fields.add_hex("sysconfig", system, 4);
    constexpr std::array<std::int64_t, 8> kFrequency{75, 150, 300, 600, 1200, 2400, 0, 0};
    fields.add("freq_khz", kFrequency[system & 7U]);
    fields.add("up", system >> 7 & 1U);
    constexpr std::array<std::int64_t, 4> kAngle{15, 20, 30, 0};
    fields.add("beam_angle_deg", kAngle[system >> 8 & 3U]);
  }
  fixed("n_beams", [](Bytes b) { return b[8]; });
  fixed("n_cells", [](Bytes b) { return b[9]; });
  fixed("pings", [](Bytes b) { return little<std::uint16_t>(b, 10); });
  fixed("cell_cm", [](Bytes b) { return little<std::uint16_t>(b, 12); });
  fixed("blank_cm", [](Bytes b) { return little<std::uint16_t>(b, 14); });
  if (fixed_.empty()) {
    for (const char* name : {"coord_byte", "frame"}) fields.add(name, "");
  } else {
    fields.add_hex("coord_byte", fixed_[25], 2);
    fields.add("frame", name(static_cast<DvlFrame>(fixed_[25] >> 3 & 3)));
  }
  fixed("tilts_used", [](Bytes b) { return b[25] >> 2 & 1; });
  fixed("three_beam", [](Bytes b) { return b[25] >> 1 & 1; });
  fixed("bin_map", [](Bytes b) { return b[25] & 1; });
  hundredths("head_align_deg", fixed_, 26, 2, true);
  hundredths("head_bias_deg", fixed_, 28, 2, true);
  fixed("bin1_cm", [](Bytes b) { return little<std::uint16_t>(b, 32); });
  fixed("xmit_cm", [](Bytes b) { return little<std::uint16_t>(b, 34); });

  const auto variable = [&](const char* name, std::size_t needed, auto read) {
    const bool there = variable_.size() >= needed;
    fields.add(name, there ? std::optional<std::int64_t>{read(variable_)} : std::optional<std::int64_t>{});
  };
  variable("ens", 46, [](Bytes b) { return little<std::uint16_t>(b, 2) + 65536 * b[11]; });
  if (variable_.empty()) {
    fields.add("rtc", "");
  } else {
    std::array<char, 40> text{};
    const Bytes v = variable_;
    const int length = std::snprintf(text.data(), text.size(), "%04d-%02d-%02dT%02d:%02d:%02d.%02d", 2000 + v[4], v[5],
                                     v[6], v[7], v[8], v[9], v[10]);
    fields.add("rtc", std::string_view{text.data(), static_cast<std::size_t>(length)});
  }
  variable("bit", 46, [](Bytes b) { return little<std::uint16_t>(b, 12); });
  variable("sos_mps", 46, [](Bytes b) { return little<std::uint16_t>(b, 14); });
  variable("depth_dm", 46, [](Bytes b) { return little<std::uint16_t>(b, 16); });
  hundredths("heading_deg", variable_, 18, 2, false);
  hundredths("pitch_deg", variable_, 20, 2, true);
  hundredths("roll_deg", variable_, 22, 2, true);
  variable("salinity_ppt", 46, [](Bytes b) { return little<std::uint16_t>(b, 24); });
  hundredths("temp_c", variable_, 26, 2, true);
  variable("pressure_dapa", 56, [](Bytes b) { return little<std::uint32_t>(b, 48); });
}

void Pd0::describe_profile(Fields& fields) const {
  const std::size_t count = cells();
  constexpr std::array kFirst{"vel1_1_mmps", "vel1_2_mmps", "vel1_3_mmps", "vel1_4_mmps"};
  for (std::size_t beam = 0; beam < 4; ++beam) {
    fields.add(kFirst[beam], count > 0 ? std::optional{velocity(0, beam)} : std::nullopt);
  }
  std::int64_t valid = 0;
  std::int64_t total = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t beam = 0; beam < 4; ++beam) {
      const std::int16_t value = velocity(i, beam);
      if (value == kBad) continue;
      ++valid;
      total += value;
    }
  }
  const auto with_profile = [&](const char* name, Bytes block, std::uint64_t value) {
    fields.add(name, block.empty() ? std::optional<std::uint64_t>{} : std::optional{value});
  };
  const auto whole = [&](Bytes block) { return block.first(std::min<std::size_t>(block.size(), 4 * count)); };
  fields.add("vel_valid_count", velocity_.empty() ? std::optional<std::int64_t>{} : std::optional{valid});
  fields.add("vel_valid_sum", velocity_.empty() ? std::optional<std::int64_t>{} : std::optional{total});
  with_profile("corr_sum", correlation_, sum(whole(correlation_)));
  with_profile("echo_sum", echo_, sum(whole(echo_)));
  with_profile("pgood_sum", good_, sum(whole(good_)));
}

void Pd0::describe_bottom(Fields& fields) const {
  const auto field = [&](const char* name, Bytes block, std::size_t needed, auto read) {
    const bool there = block.size() >= needed && !block.empty();
    fields.add(name, there ? std::optional<std::int64_t>{read(block)} : std::optional<std::int64_t>{});
  };
  const Bytes b = bottom_;
  field("bt_len", b, 1, [](Bytes block) { return block.size(); });
  field("bt_pings", b, 4, [](Bytes block) { return little<std::uint16_t>(block, 2); });
  const auto four = [&](const std::array<const char*, 4>& names, Bytes block, std::size_t needed, auto read) {
    for (std::size_t i = 0; i < 4; ++i) field(names[i], block, needed, [&](Bytes bytes) { return read(bytes, i); });
  };
  four({"bt_range1_cm", "bt_range2_cm", "bt_range3_cm", "bt_range4_cm"}, b, 24, [](Bytes block, std::size_t i) {
    const unsigned high = block.size() >= 81 ? block[77 + i] : 0U;
    return static_cast<std::int64_t>(little<std::uint16_t>(block, 16 + 2 * i) + (high << 16));
  });
  four({"bt_vel1_mmps", "bt_vel2_mmps", "bt_vel3_mmps", "bt_vel4_mmps"}, b, 32,
       [](Bytes block, std::size_t i) { return little<std::int16_t>(block, 24 + 2 * i); });
  four({"bt_corr1", "bt_corr2", "bt_corr3", "bt_corr4"}, b, 36,
       [](Bytes block, std::size_t i) { return block[32 + i]; });
  four({"bt_amp1", "bt_amp2", "bt_amp3", "bt_amp4"}, b, 40, [](Bytes block, std::size_t i) { return block[36 + i]; });
  four({"bt_pg1", "bt_pg2", "bt_pg3", "bt_pg4"}, b, 44, [](Bytes block, std::size_t i) { return block[40 + i]; });
  four({"bthr_vel1_um10ps", "bthr_vel2_um10ps", "bthr_vel3_um10ps", "bthr_vel4_um10ps"}, fine_bottom_, 70,
       [](Bytes block, std::size_t i) { return little<std::int32_t>(block, 2 + 4 * i); });
  field("btr_slant_tenth_mm", fine_range_, 41, [](Bytes block) { return little<std::uint32_t>(block, 2); });
  field("btr_vertical_tenth_mm", fine_range_, 41, [](Bytes block) { return little<std::uint32_t>(block, 10); });
}

}  // namespace fathom::devices
