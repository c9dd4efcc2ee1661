// Flight modes of ArduSub by name and by the number in HEARTBEAT's custom_mode (ArduSub's enum Mode::Number).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fathom::devices {

struct ArdusubMode {
  std::uint32_t number{};
  std::string_view name;
};
inline constexpr std::array kArdusubModes{
    ArdusubMode{0, "STABILIZE"},     ArdusubMode{1, "ACRO"},     ArdusubMode{2, "ALT_HOLD"},
    ArdusubMode{3, "AUTO"},          ArdusubMode{4, "GUIDED"},   ArdusubMode{7, "CIRCLE"},
    ArdusubMode{9, "SURFACE"},       ArdusubMode{16, "POSHOLD"}, ArdusubMode{19, "MANUAL"},
    ArdusubMode{20, "MOTOR_DETECT"}, ArdusubMode{21, "SURFTRAK"}};

[[nodiscard]] inline std::optional<std::uint32_t> ardusub_mode(std::string_view name) {
  for (const ArdusubMode& mode : kArdusubModes) {
    if (mode.name == name) return mode.number;
  }
  return {};
}
/// "mode 42" where the number is not known.
[[nodiscard]] inline std::string ardusub_mode_name(std::uint32_t number) {
  for (const ArdusubMode& mode : kArdusubModes) {
    if (mode.number == number) return std::string{mode.name};
  }
  return "mode " + std::to_string(number);
}

}  // namespace fathom::devices
