// MAVLink 1 and 2: the few messages that a thruster driver needs, in and out. ArduSub is the other side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

namespace mavlink {

/// Fields in wire order: Q u64, I u32, i i32, H u16, h i16, B u8, b i8, f float. The extra byte of the CRC stands for
/// the definition of the message, so that nobody reads fields of another version.
struct Message {
  std::uint32_t id;
  std::string_view name;
  std::uint8_t crc_extra;
  std::string_view fields;
};
[[nodiscard]] std::span<const Message> messages();
/// Null when this message is not known.
[[nodiscard]] const Message* message(std::uint32_t id);

/// Writes MAVLink 2 packets as one system.
class Writer {
 public:
  Writer(std::uint8_t system, std::uint8_t component) : system_{system}, component_{component} {}
  /// A ground station's sign of life; ArduSub stops the thrusters when it stays away.
  [[nodiscard]] std::string heartbeat();
  /// Pilot's sticks, us: pitch, roll, throttle, yaw, forward, lateral; 65535 leaves a channel alone.
  [[nodiscard]] std::string rc_override(const std::array<std::uint16_t, 8>& channels, std::uint8_t target);
  /// One motor (from 0) to `pwm` [us] for `seconds`; ArduSub wants it again at 2 Hz at least.
  [[nodiscard]] std::string motor_test(std::size_t motor, double pwm, double seconds, std::uint8_t target);
  /// What a vehicle answers to a command; for emulators.
  [[nodiscard]] std::string command_ack(std::uint16_t command, std::uint8_t result);

 private:
  [[nodiscard]] std::string packet(std::uint32_t id, std::string payload);
  std::uint8_t system_, component_, sequence_{};
};

}  // namespace mavlink

/// SERVO_OUTPUT_RAW gives Thrusters samples (pwm only), SYS_STATUS and BATTERY_STATUS the battery's voltage. The CRC of
/// a message that is not known cannot be checked; its bytes are skipped. A tlog can be fed as it is.
class Mavlink final : public Parser {
 public:
  explicit Mavlink(const Settings& settings);
  void describe(Fields& fields) const override;

  [[nodiscard]] std::uint32_t id() const { return id_; }
  /// Who sent the latest message.
  [[nodiscard]] int system() const;
  [[nodiscard]] int component() const;
  /// A field of the latest message, by its place in wire order.
  [[nodiscard]] double value(std::size_t field) const;
  /// What STATUSTEXT says to the operator.
  [[nodiscard]] std::string text() const;

 private:
  static constexpr std::size_t kMostPayload = 255;
  struct Header {
    std::size_t size{};     ///< of the header, from the magic byte on
    std::size_t payload{};  ///< bytes on the wire
    std::size_t trailer{};  ///< CRC and signature
    std::uint32_t id{};
  };
  [[nodiscard]] static Header header(Bytes bytes);
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;

  Bytes bytes_;
  std::uint32_t id_{};
  const mavlink::Message* message_{};
  std::array<std::uint8_t, kMostPayload + 8> payload_{};  ///< padded: zero bytes at the end are not sent
  std::size_t motors_;
  Battery battery_;
  Thrusters thrusters_;
};

}  // namespace fathom::devices
