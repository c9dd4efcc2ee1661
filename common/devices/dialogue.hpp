// What has to be said to an instrument before its data can be trusted: configure, read back, refuse on a mismatch.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/devices/emulation/emulated_vehicle.hpp"
#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// One exchange after each opening of the line. Pure: time is passed in, bytes to send are returned.
class Dialogue {
 public:
  virtual ~Dialogue() = default;
  /// The line is up. Returns bytes to send.
  [[nodiscard]] virtual std::string begin(double now) = 0;
  /// A frame came. Returns bytes to send.
  [[nodiscard]] virtual std::string hear(const Parser& parser, const Frame& frame, double now) = 0;
  /// Called a few times a second: repeats what was not answered.
  [[nodiscard]] virtual std::string tick(double now) = 0;
  /// Samples may be used.
  [[nodiscard]] virtual bool done() const = 0;
  /// Why it does not get on; one line with the remedy. Empty while all is well.
  [[nodiscard]] virtual std::string failure() const = 0;
};

/// Null for protocols whose instruments speak by themselves.
[[nodiscard]] std::unique_ptr<Dialogue> make_dialogue(std::string_view protocol, const Settings& settings);

/// The instrument's side, for emulators: takes what a driver sends, returns the answer.
class EmulatedAnswers {
 public:
  explicit EmulatedAnswers(std::string_view protocol);
  [[nodiscard]] std::string hear(std::string_view bytes);
  /// An instrument that waits to be told does not send data before.
  [[nodiscard]] bool sends_data() const { return sends_; }
  /// Pulse widths that thrusters were told; neutral again half a second after the last command.
  [[nodiscard]] const std::vector<double>& applied() const { return applied_; }
  /// The same of a rig that was told forces [N]; empty until it was.
  [[nodiscard]] const std::vector<double>& applied_force() const { return applied_force_; }
  /// Deflections of the pilot's sticks that a vehicle was told, -1 to 1: pitch, roll, throttle, yaw, forward, lateral.
  /// Null while nobody overrides them.
  [[nodiscard]] const std::array<double, 6>* sticks() const { return overridden_ ? &sticks_ : nullptr; }
  /// Of the vehicle that is played behind a thruster driver; what it is told it does only when it is well.
  [[nodiscard]] EmulatedVehicle& vehicle() { return vehicle_; }
  [[nodiscard]] const EmulatedVehicle& vehicle() const { return vehicle_; }
  /// Time goes on [s].
  void at(double now);

 private:
  [[nodiscard]] std::string answer_ig500(Bytes frame);
  [[nodiscard]] std::string answer_water_linked(std::string_view line);
  void hear_rig(std::string_view line);
  [[nodiscard]] std::string hear_mavlink(std::string_view bytes);

  std::string protocol_;
  std::string waiting_;
  std::uint8_t output_mode_{2};  ///< not what a driver asks for, so that configuring shows
  std::uint32_t mask_{0};
  std::uint8_t continuous_{0}, divider_{1};
  bool sends_;
  std::vector<double> applied_, applied_force_;
  std::array<double, 6> sticks_{};
  bool overridden_{false};
  double now_{}, commanded_{}, overridden_at_{};
  EmulatedVehicle vehicle_;
  std::unique_ptr<Parser> commands_;  ///< of a ground station (MAVLink)
};

}  // namespace fathom::devices
