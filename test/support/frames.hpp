// What the tests of frames, signs and units by hand share: bytes by hand, a tilted vehicle, samples read back.
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/devices/attitude.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "test/support/wire_data.hpp"

namespace fathom::test {

constexpr double kMillimetre = 1.1e-3;  // m/s: what PD0, PD4 and PD6 round to, in each of two axes
constexpr double kHundredth = 2e-4;     // rad: a hundredth of a degree, twice
constexpr double kSingle = 1e-6;        // single precision of numbers about 10
constexpr double kCentimetre = 0.012;   // m

inline std::vector<WireRow> decode(const std::string& protocol, const std::string& bytes,
                                   const devices::Settings& settings = {}) {
  const devices::Protocol& known = devices::protocol(protocol, "test");
  const auto parser = known.make(settings);
  return decode_wire(*parser, known, settings, bytes);
}

inline std::string unhex(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 3) {
    bytes += static_cast<char>(std::stoi(text.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

inline devices::Instant tilted() {
  devices::Instant now{.time = 1'700'000'000.25};
  now.ahrs.q_WB = Eigen::Quaterniond{rotation_from_euler({0.15, -0.1, 2.5})};
  now.ahrs.w_WB_B = {0.1, -0.2, 0.3};
  now.ahrs.f_B = {0.5, -0.25, -9.75};
  now.ahrs.has_rates = now.ahrs.has_specific_force = now.ahrs.has_attitude = true;
  now.dvl = Dvl{.v_WB_B = {1.2, -0.3, 0.2}, .altitude = 12.34};
  return now;
}

inline void check_vector(const WireRow& row, const std::array<const char*, 3>& names, const Eigen::Vector3d& wanted,
                         double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    CAPTURE(names[i]);
    CHECK(std::abs(row.value(std::string{"SI "} + names[i]) - wanted(static_cast<Eigen::Index>(i))) < tolerance);
  }
}

inline Eigen::Vector3d velocity(const WireRow& row) {
  return {row.value("SI u [m/s]"), row.value("SI v [m/s]"), row.value("SI w [m/s]")};
}
inline Eigen::Quaterniond attitude(const WireRow& row) {
  return {row.value("SI qw"), row.value("SI qx"), row.value("SI qy"), row.value("SI qz")};
}
inline Eigen::Vector3d fix(const WireRow& row) {
  return {row.value("SI north [m]"), row.value("SI east [m]"), row.value("SI down [m]")};
}

}  // namespace fathom::test
