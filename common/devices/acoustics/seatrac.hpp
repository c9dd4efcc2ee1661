// Blueprint Subsea SeaTrac beacons: "$" and a message in hexadecimal digits, with a checksum.
#pragma once

#include <array>
#include <optional>

#include "common/devices/parser.hpp"
#include "common/devices/positions.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// Answers of a beacon to the X150 (ping, echo, navigation query, datagram) give a sample where their fix holds a
/// position. Its north is magnetic; state `declination`. Beacons are called by their number, "3".
class Seatrac final : public Parser {
 public:
  explicit Seatrac(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  static constexpr std::size_t kMostBytes = 320;
  struct Fix {
    std::uint8_t source{}, flags{};
    std::int16_t yaw{}, pitch{}, roll{}, rssi{};
    std::uint16_t depth{}, sound_speed{};
    std::optional<std::uint16_t> distance;
    std::optional<std::int16_t> azimuth, elevation, fit_error;
    std::optional<std::int16_t> easting, northing, down;
  };
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  [[nodiscard]] static std::optional<Fix> read_fix(Bytes bytes);

  Transceiver from_;
  WantedBeacon wanted_;
  std::array<std::uint8_t, kMostBytes> message_{};
  std::size_t size_{};
  std::optional<Fix> fix_;
  Usbl sample_;
};

}  // namespace fathom::devices
