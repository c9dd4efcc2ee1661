// What an instrument would send: samples back to bytes, for emulators and tests. Only what the parsers read is filled.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/devices/emulation/emulated_vehicle.hpp"
#include "common/devices/settings.hpp"
#include "common/devices/velocity/janus.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::devices {

/// What is true at one moment. Emulated instruments are mounted along the body's axes.
struct Instant {
  double time{};  ///< s since 1970
  Ahrs ahrs;
  Dvl dvl;
  Usbl usbl;
  Depth depth;
  Ranges ranges;
  Loads loads;
  Thrusters thrusters;        ///< pulse widths; of a rig without any, forces
  double voltage{16.2};       ///< V, of the battery; 0: nothing is said of it
  EmulatedVehicle vehicle{};  ///< behind a thruster driver
};

struct EmulatedDvl {
  DvlFrame frame{DvlFrame::kShip};
  double beam_angle_deg{30.0};  ///< 15, 20 or 30
  int bad_beam{-1};             ///< this one (0 to 3) has no echo
};

/// The bytes of one report. InputError when the protocol is not known.
[[nodiscard]] std::string emulate(std::string_view protocol, const Instant& now, const Settings& settings,
                                  const EmulatedDvl& dvl = {});
/// Reports per second that such an instrument usually sends.
[[nodiscard]] double emulated_rate(std::string_view protocol);

/// Lengths from the instrument along the beams' axes and velocities along the beams, as PD0 has them.
[[nodiscard]] std::array<double, 4> emulated_beam_velocities(const Eigen::Vector3d& v_BS_S, double beam_angle);

/// A vehicle that swims a gentle curve: the truth behind `fathom emulate` without a recording.
[[nodiscard]] Instant emulated_motion(double time, double since_start, const Settings& settings);

namespace detail {
[[nodiscard]] std::string emulate_ahrs(std::string_view protocol, const Instant& now, const Settings& settings);
[[nodiscard]] std::string emulate_dvl(std::string_view protocol, const Instant& now, const Settings& settings,
                                      const EmulatedDvl& dvl);
[[nodiscard]] std::string emulate_text(std::string_view protocol, const Instant& now, const Settings& settings);
/// "$" body "*hh" CR LF.
[[nodiscard]] std::string nmea_sentence(const std::string& body);
/// printf into a string.
[[nodiscard]] __attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...);

/// Appends numbers to a frame.
class FrameWriter {
 public:
  template <class T>
  void little(T value) {
    put(value, false);
  }
  template <class T>
  void big(T value) {
    put(value, true);
  }
  void zeros(std::size_t count) { text.append(count, '\0'); }
  std::string text;

 private:
  template <class T>
  void put(T value, bool reversed) {
    char raw[sizeof(T)];
    __builtin_memcpy(raw, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) text += raw[reversed ? sizeof(T) - 1 - i : i];
  }
};
}  // namespace detail

}  // namespace fathom::devices
