// TE MS5837-30BA and -02BA (Bar30, Bar02): pressure sensor on an I2C bus.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

namespace fathom::devices {

/// The only thing a sensor on I2C needs. Throws InputError when the device does not answer.
class I2cBus {
 public:
  virtual ~I2cBus() = default;
  virtual void write(std::uint8_t address, std::uint8_t command) = 0;
  virtual void read(std::uint8_t address, std::span<std::uint8_t> into) = 0;
};

namespace ms5837 {

enum class Model : std::uint8_t { k30Ba, k02Ba };
/// Nothing for an unknown name; "30BA" and "02BA" are known.
[[nodiscard]] std::optional<Model> model(std::string_view name);

using Prom = std::array<std::uint16_t, 7>;  ///< C0 (with the CRC) to C6
[[nodiscard]] bool crc_right(const Prom& prom);

struct Reading {
  double pressure{};     ///< Pa
  double temperature{};  ///< deg C
};
/// What the datasheet calls first order, for tests, and what is to be used.
struct Compensated {
  Reading first_order;
  Reading second_order;
};
/// From the raw pressure d1 and temperature d2 (24 bits).
[[nodiscard]] Compensated compensate(Model model, const Prom& prom, std::uint32_t d1, std::uint32_t d2);

/// Talks to one sensor. `wait(seconds)` is the caller's, so that tests need not.
class Sensor {
 public:
  using Wait = std::function<void(double)>;
  /// Resets the sensor and reads its constants; InputError when they are damaged.
  Sensor(I2cBus& bus, Model model, Wait wait);
  /// One measurement, about 41 ms. Nothing when the sensor was read too early.
  [[nodiscard]] std::optional<Reading> measure();

 private:
  [[nodiscard]] std::uint32_t convert(std::uint8_t command);

  I2cBus& bus_;
  Model model_;
  Wait wait_;
  Prom prom_{};
};

}  // namespace ms5837
}  // namespace fathom::devices
