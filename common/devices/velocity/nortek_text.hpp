// Nortek's velocity logs in text: $PNORBT0 to $PNORBT9 (data formats 350 to 359), with or without names before the
// values.
#pragma once

#include <array>
#include <optional>

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// $PNORBT6 to $PNORBT9 give samples: X forward, Y to starboard, Z out of the transducers, in the vehicle's sign. The
/// others tell one beam, or a speed and a course, and are frames only. -32.768 m/s, a distance of 0 and a figure of
/// merit of 10 m/s are no values.
class NortekText final : public NmeaParser {
 public:
  explicit NortekText(const Settings& settings);

 private:
  static constexpr std::size_t kValues = 16;
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;
  [[nodiscard]] bool read(const Words& words);
  [[nodiscard]] std::optional<double> value(std::size_t i) const;

  Eigen::Matrix3d R_BS_;
  std::array<std::string_view, kValues> told_{};  ///< in the order of the format, without their names
  std::optional<std::uint32_t> status_;
  Dvl sample_;
};

}  // namespace fathom::devices
