// Every protocol by name: what to select in a driver's configuration or on the command line of `fathom decode`.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

enum class Kind : std::uint8_t { kAhrs, kDvl, kUsbl, kRanges, kDepth, kLoads, kThrusters };

struct Protocol {
  std::string_view name;
  Kind kind;
  std::string_view title;  ///< for --help
  int baud;                ///< usual rate of the line; 0: not a serial line
  std::unique_ptr<Parser> (*make)(const Settings& settings);
  double tick{0.0};  ///< s, steps in which its frames tell time, where they are not much finer than a millisecond
  double turn{0.0};  ///< s, after which its clock counts from zero again; 0: never
};

[[nodiscard]] std::span<const Protocol> protocols();
/// InputError that lists the known names (of `kind`, when one is given) for an unknown one; `where` begins it.
[[nodiscard]] const Protocol& protocol(std::string_view name, const std::string& where, const Kind* kind = nullptr);

/// Reads the keys that instruments of this kind need from a driver's section.
[[nodiscard]] Settings read_settings(const Config& config, const Protocol& protocol);

}  // namespace fathom::devices
