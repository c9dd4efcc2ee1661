#include "common/devices/ms5837.hpp"

#include <cmath>

#include "common/base/error.hpp"

namespace fathom::devices::ms5837 {
namespace {

constexpr std::uint8_t kAddress = 0x76;
constexpr std::uint8_t kReset = 0x1E, kReadProm = 0xA0, kReadAdc = 0x00;
constexpr std::uint8_t kPressure = 0x4A, kTemperature = 0x5A;  // oversampling 8192
constexpr double kResetTime = 0.010;                           // s
constexpr double kConversionTime = 0.0205;                     // s at oversampling 8192

double square(double value) { return value * value; }

struct Correction {
  double temperature{}, offset{}, sensitivity{};
};

// The datasheets' second order; T in 0.01 deg C.
Correction second_order(Model model, double d_T, double T) {
  const double below = square(T - 2000.0);
  if (model == Model::k02Ba) {
    if (T >= 2000.0) return {};
    return {std::ldexp(11.0 * square(d_T), -35), 31.0 * below / 8.0, 63.0 * below / 32.0};
  }
  if (T >= 2000.0) return {std::ldexp(2.0 * square(d_T), -37), below / 16.0, 0.0};
  Correction cold{std::ldexp(3.0 * square(d_T), -33), 3.0 * below / 2.0, 5.0 * below / 8.0};
  if (T < -1500.0) {
    cold.offset += 7.0 * square(T + 1500.0);
    cold.sensitivity += 4.0 * square(T + 1500.0);
  }
  return cold;
}

}  // namespace

std::optional<Model> model(std::string_view name) {
  if (name == "30BA") return Model::k30Ba;
  if (name == "02BA") return Model::k02Ba;
  return {};
}

bool crc_right(const Prom& prom) {
  std::uint32_t rem = 0;
  for (std::size_t i = 0; i < 16; ++i) {
    const std::uint16_t word = i / 2 == 0 ? prom[0] & 0x0FFFU : i / 2 < prom.size() ? prom[i / 2] : 0U;
    rem ^= i % 2 == 0 ? word >> 8 : word & 0xFFU;
    for (int bit = 0; bit < 8; ++bit) rem = ((rem & 0x8000U) != 0 ? rem << 1 ^ 0x3000U : rem << 1) & 0xFFFFU;
  }
  return rem >> 12 == static_cast<std::uint32_t>(prom[0] >> 12);
}

// The datasheets' arithmetic without its rounding, which would cost a millimetre of depth.
Compensated compensate(Model model, const Prom& prom, std::uint32_t d1, std::uint32_t d2) {
  const bool bar30 = model == Model::k30Ba;
  const double d_T = static_cast<double>(d2) - 256.0 * prom[5];
  const double T = 2000.0 + std::ldexp(d_T * prom[6], -23);
  const double offset = std::ldexp(prom[2], bar30 ? 16 : 17) + std::ldexp(prom[4] * d_T, bar30 ? -7 : -6);
  const double sensitivity = std::ldexp(prom[1], bar30 ? 15 : 16) + std::ldexp(prom[3] * d_T, bar30 ? -8 : -7);
  const auto reading = [&](double temperature, double off, double sens) {
    const double counts = std::ldexp(std::ldexp(d1 * sens, -21) - off, bar30 ? -13 : -15);
    return Reading{.pressure = counts * (bar30 ? 10.0 : 1.0), .temperature = 0.01 * temperature};
  };
  const Correction correction = second_order(model, d_T, T);
  return {.first_order = reading(T, offset, sensitivity),
          .second_order =
              reading(T - correction.temperature, offset - correction.offset, sensitivity - correction.sensitivity)};
}

Sensor::Sensor(I2cBus& bus, Model model, Wait wait) : bus_{bus}, model_{model}, wait_{std::move(wait)} {
  bus_.write(kAddress, kReset);
  wait_(kResetTime);
  for (std::size_t i = 0; i < prom_.size(); ++i) {
    std::array<std::uint8_t, 2> word{};
    bus_.write(kAddress, static_cast<std::uint8_t>(kReadProm + 2 * i));
    bus_.read(kAddress, word);
    prom_[i] = static_cast<std::uint16_t>(word[0] << 8 | word[1]);
  }
  if (!crc_right(prom_)) {
    throw InputError("MS5837: its calibration constants fail their CRC; check wiring, address 0x76 and bus speed");
  }
}

std::uint32_t Sensor::convert(std::uint8_t command) {
  bus_.write(kAddress, command);
  wait_(kConversionTime);
  std::array<std::uint8_t, 3> raw{};
  bus_.write(kAddress, kReadAdc);
  bus_.read(kAddress, raw);
  return static_cast<std::uint32_t>(raw[0] << 16 | raw[1] << 8 | raw[2]);
}

std::optional<Reading> Sensor::measure() {
  const std::uint32_t d1 = convert(kPressure);
  const std::uint32_t d2 = convert(kTemperature);
  if (d1 == 0 || d2 == 0) return {};  // zero means: not ready
  return compensate(model_, prom_, d1, d2).second_order;
}

}  // namespace fathom::devices::ms5837
