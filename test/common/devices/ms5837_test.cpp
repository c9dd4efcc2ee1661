// MS5837: the datasheets' numbers, and the dialogue on a bus that a test can hold.
#include "common/devices/ms5837.hpp"

#include <doctest/doctest.h>

#include <map>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"
#include "test/support/wire_data.hpp"

using namespace fathom;
using namespace fathom::devices;

namespace {

constexpr double kPressure = 0.02;       // Pa: the table prints four decimals of a millibar
constexpr double kTemperature = 0.0001;  // deg C

ms5837::Prom with_crc(ms5837::Prom prom) {
  for (unsigned crc = 0; crc < 16; ++crc) {
    prom[0] = static_cast<std::uint16_t>((prom[0] & 0x0FFFU) | crc << 12);
    if (ms5837::crc_right(prom)) return prom;
  }
  return prom;
}

class PretendSensor final : public I2cBus {
 public:
  explicit PretendSensor(const ms5837::Prom& prom) : prom_{prom} {}
  void write(std::uint8_t address, std::uint8_t command) override {
    if (address != 0x76) throw InputError("nobody answers");
    if (command != 0) converting_ = command;
    last_ = command;
    ++writes;
  }
  void read(std::uint8_t, std::span<std::uint8_t> into) override {
    std::uint32_t value = converting_ == 0x4A ? d1 : d2;
    if (last_ >= 0xA0) value = prom_.at((last_ - 0xA0U) / 2);
    for (std::size_t i = into.size(); i-- > 0; value >>= 8) into[i] = static_cast<std::uint8_t>(value & 0xFFU);
  }
  std::uint32_t d1{4958179}, d2{6815414};
  int writes{};

 private:
  ms5837::Prom prom_;
  std::uint8_t converting_{}, last_{};
};

const ms5837::Prom kDatasheet{0, 34982, 36352, 20328, 22354, 26646, 26146};

}  // namespace

TEST_CASE("MS5837: every row of the datasheets' and the second-order table") {
  int rows = 0;
  for (const auto& row : test::wire_table("ms5837_vectors/expected.csv")) {
    std::map<std::string, std::string> cell{row.begin(), row.end()};
    CAPTURE(cell["origin"]);
    ms5837::Prom prom{};
    for (std::size_t i = 1; i < 7; ++i) prom[i] = static_cast<std::uint16_t>(std::stoul(cell["c" + std::to_string(i)]));
    const auto model = ms5837::model(cell["model"]);
    REQUIRE(model);
    const auto result = ms5837::compensate(*model, prom, static_cast<std::uint32_t>(std::stoul(cell["d1"])),
                                           static_cast<std::uint32_t>(std::stoul(cell["d2"])));
    CHECK(std::abs(result.first_order.pressure - 100.0 * std::stod(cell["p1_mbar"])) < kPressure);
    CHECK(std::abs(result.first_order.temperature - std::stod(cell["temp1_c"])) < kTemperature);
    CHECK(std::abs(result.second_order.pressure - 100.0 * std::stod(cell["p2_mbar"])) < kPressure);
    CHECK(std::abs(result.second_order.temperature - std::stod(cell["temp2_c"])) < kTemperature);
    ++rows;
  }
  CHECK(rows == 6);
}

TEST_CASE("MS5837: constants with a wrong CRC are refused") {
  const ms5837::Prom good = with_crc(kDatasheet);
  CHECK(ms5837::crc_right(good));
  for (std::size_t word = 0; word < good.size(); ++word) {
    for (unsigned bit = 0; bit < 16; ++bit) {
      ms5837::Prom bad = good;
      bad[word] = static_cast<std::uint16_t>(bad[word] ^ 1U << bit);
      CHECK_FALSE(ms5837::crc_right(bad));
    }
  }
  PretendSensor bus{{1, 2, 3, 4, 5, 6, 7}};
  CHECK(test::complaint_of<InputError>([&] { ms5837::Sensor(bus, ms5837::Model::k30Ba, [](double) {}); }).find("CRC") !=
        std::string::npos);
}

TEST_CASE("MS5837: reset, constants, two conversions, and a reading") {
  PretendSensor bus{with_crc(kDatasheet)};
  double waited = 0.0;
  ms5837::Sensor sensor{bus, ms5837::Model::k30Ba, [&](double seconds) { waited += seconds; }};
  const auto reading = sensor.measure();
  REQUIRE(reading);
  CHECK(reading->pressure == doctest::Approx(399980.0).epsilon(1e-4));
  CHECK(reading->temperature == doctest::Approx(19.81).epsilon(1e-3));
  CHECK(waited > 0.040);  // two conversions of 20 ms
  CHECK(bus.writes == 1 + 7 + 4);
  bus.d1 = 0;  // read too early
  CHECK_FALSE(sensor.measure());
}
