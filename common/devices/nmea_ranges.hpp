// Acoustic ranges to transponders on the seabed: Kongsberg $PSIMLBM.
#pragma once

#include <array>
#include <string_view>

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// Up to eight ranges in the order of the array; an empty one was not measured.
class NmeaRanges final : public NmeaParser {
 public:
  explicit NmeaRanges(const Settings& settings);

 private:
  static constexpr std::size_t kMost = 8;
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;

  std::size_t count_;
  double sound_speed_;
  std::string_view array_, unit_;
  std::optional<double> time_, roll_deg_, pitch_deg_, course_deg_, depth_m_;
  std::array<std::optional<double>, kMost> told_;
  Ranges sample_;
};

}  // namespace fathom::devices
