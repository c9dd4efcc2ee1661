#include "common/devices/ms5837.hpp"

#include "common/base/error.hpp"

namespace fathom::devices::ms5837 {
namespace {

constexpr std::uint8_t kAddress = 0x76;
constexpr std::uint8_t kReset = 0x1E, kReadProm = 0xA0, kReadAdc = 0x00;
constexpr std::uint8_t kPressure = 0x4A, kTemperature = 0x5A;  // oversampling 8192
constexpr double kResetTime = 0.010;                           // s
constexpr double kConversionTime = 0.0205;                     // s at oversampling 8192

std::int64_t square(std::int64_t value) { return value * value; }

struct Correction {
  std::int64_t temperature{}, offset{}, sensitivity{};
};

// The datasheets' second order; T in 0.01 deg C.
Correction second_order(Model model, std::int64_t dT, std::int64_t T) {
  const std::int64_t below = square(T - 2000);
  if (model == Model::k02Ba) {
    if (T >= 2000) return {};
    return {11 * square(dT) >> 35, 31 * below >> 3, 63 * below >> 5};
  }
  if (T >= 2000) return {2 * square(dT) >> 37, below >> 4, 0};
  Correction cold{3 * square(dT) >> 33, 3 * below >> 1, 5 * below >> 3};
  if (T < -1500) {
    cold.offset += 7 * square(T + 1500);
    cold.sensitivity += 4 * square(T + 1500);
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

Compensated compensate(Model model, const Prom& prom, std::uint32_t d1, std::uint32_t d2) {
  const bool bar30 = model == Model::k30Ba;
  const std::int64_t dT = std::int64_t{d2} - std::int64_t{prom[5]} * 256;
  const std::int64_t T = 2000 + (dT * prom[6]) / 8388608;
  const std::int64_t offset =
      bar30 ? std::int64_t{prom[2]} * 65536 + prom[4] * dT / 128 : std::int64_t{prom[2]} * 131072 + prom[4] * dT / 64;
  const std::int64_t sensitivity =
      bar30 ? std::int64_t{prom[1]} * 32768 + prom[3] * dT / 256 : std::int64_t{prom[1]} * 65536 + prom[3] * dT / 128;
  const std::int64_t divisor = bar30 ? 8192 : 32768;
  const double unit = bar30 ? 10.0 : 1.0;  // Pa in one count of the result
  const auto reading = [&](std::int64_t temperature, std::int64_t off, std::int64_t sens) {
    const std::int64_t pressure = (d1 * sens / 2097152 - off) / divisor;
    return Reading{.pressure = static_cast<double>(pressure) * unit,
                   .temperature = 0.01 * static_cast<double>(temperature)};
  };
  const Correction correction = second_order(model, dT, T);
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
