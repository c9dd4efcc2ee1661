// MAVLink against a recording of a real vehicle, its definitions, and what the driver sends.
#include "common/devices/mavlink.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "common/devices/checksum.hpp"
#include "common/devices/dialogue.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/thruster_text.hpp"
#include "test/support/wire_data.hpp"

using namespace fathom;
using namespace fathom::test;

namespace {

constexpr double kPrinted = 1e-8;  // relative: the table prints nine digits

std::vector<WireRow> decode(const std::string& protocol, const std::string& bytes) {
  const devices::Protocol& known = devices::protocol(protocol, "test");
  const auto parser = known.make({});
  return decode_wire(*parser, known, {}, bytes);
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text{line};
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

TEST_CASE("MAVLink: every field of every known packet of a real vehicle's log") {
  std::map<std::uint64_t, WireRow> by_offset;
  for (WireRow& row : decode("mavlink", wire_bytes("mavlink_ardusub_tlog/small.tlog"))) {
    const std::uint64_t offset = row.offset;
    by_offset.emplace(offset, std::move(row));
  }
  std::istringstream table{wire_bytes("mavlink_ardusub_tlog/expected.csv")};
  std::string line;
  std::getline(table, line);
  int compared = 0;
  while (std::getline(table, line)) {
    const auto cells = split(line);
    // The table's offset is that of the time stamp of eight bytes before the packet, as ours is.
    const auto found = by_offset.find(std::stoull(cells[0]));
    CAPTURE(line);
    REQUIRE(found != by_offset.end());
    const WireRow& row = found->second;
    CHECK(row.at("msgid") == cells[5]);
    CHECK(row.at("name") == cells[6]);
    CHECK(row.at("sysid") == cells[3]);
    for (std::size_t i = 7; i < cells.size(); ++i) {
      const double wanted = std::stod(cells[i]);
      CHECK(std::abs(row.value("f" + std::to_string(i - 6)) - wanted) <= kPrinted * std::abs(wanted));
      ++compared;
    }
  }
  MESSAGE("fields compared: ", compared);
  CHECK(compared > 9'000);
}

TEST_CASE("MAVLink: hardly any byte of a vehicle's log is not understood") {
  const devices::Protocol& known = devices::protocol("mavlink", "test");
  const auto parser = known.make({});
  (void)decode_wire(*parser, known, {}, wire_bytes("mavlink_ardusub_tlog/small.tlog"));
  const devices::Counters& counters = parser->counters();
  CHECK(counters.frames > 3'520);     // of 3,528
  CHECK(counters.bad_checksum < 20);  // false beginnings inside of those that are not known
  CHECK(counters.skipped < 500);      // the time stamps of the log are none of it
}

TEST_CASE("MAVLink: the extra bytes follow from the definitions") {
  // Name, then type and name of each field in wire order, through the same CRC, folded to eight bits.
  const auto extra = [](const std::string& definition) {
    const std::uint16_t crc = devices::crc16_reflected(devices::as_bytes(definition), 0xFFFF);
    return static_cast<std::uint8_t>((crc & 0xFFU) ^ (crc >> 8));
  };
  std::string override_text = "RC_CHANNELS_OVERRIDE ";
  for (int i = 1; i <= 8; ++i) override_text += "uint16_t chan" + std::to_string(i) + "_raw ";
  CHECK(extra(override_text + "uint8_t target_system uint8_t target_component ") ==
        devices::mavlink::message(70)->crc_extra);
  std::string command_text = "COMMAND_LONG ";
  for (int i = 1; i <= 7; ++i) command_text += "float param" + std::to_string(i) + " ";
  CHECK(extra(command_text + "uint16_t command uint8_t target_system uint8_t target_component uint8_t confirmation ") ==
        devices::mavlink::message(76)->crc_extra);
  CHECK(extra("HEARTBEAT uint32_t custom_mode uint8_t type uint8_t autopilot uint8_t base_mode uint8_t system_status "
              "uint8_t mavlink_version ") == devices::mavlink::message(0)->crc_extra);
}

TEST_CASE("MAVLink: what the driver sends is read back with the fields it meant") {
  devices::mavlink::Writer writer{255, 190};
  const auto rows =
      decode("mavlink", writer.heartbeat() + writer.rc_override({1500, 1510, 1490, 1600, 1700, 1400, 65535, 65535}, 1) +
                            writer.motor_test(3, 1623.4, 0.5, 1));
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].at("name") == "HEARTBEAT");
  CHECK(rows[0].at("f2") == "6");  // a ground station
  CHECK(rows[1].at("name") == "RC_CHANNELS_OVERRIDE");
  CHECK(rows[1].at("f5") == "1700");
  CHECK(rows[1].at("f8") == "65535");
  CHECK(rows[1].at("f9") == "1");
  CHECK(rows[2].at("f1") == "3");
  CHECK(rows[2].at("f2") == "1");  // microseconds
  CHECK(rows[2].at("f3") == "1623");
  CHECK(rows[2].at("f6") == "2");  // the board's order
  CHECK(rows[2].at("f8") == "209");
  CHECK(rows[2].at("sysid") == "255");
}

TEST_CASE("MAVLink: voltage and applied pulse widths come as samples") {
  const auto rows = decode("mavlink", devices::emulate("mavlink", devices::emulated_motion(1.7e9, 0.0, {}), {}));
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].at("name") == "HEARTBEAT");
  CHECK(rows[1].has_sample);
  CHECK(rows[2].value("SI voltage [V]") == doctest::Approx(16.2));
}

TEST_CASE("MAVLink version 1 packets are read, too") {
  std::string body{"\x06\x07\x01\x01\x4D",
                   5};  // COMMAND_ACK has three bytes; longer ones are padded fields of later days
  body[0] = 3;
  body += std::string{"\xD1\x00\x00", 3};
  const std::string checked = body + static_cast<char>(143);
  const std::uint16_t crc = devices::crc16_reflected(devices::as_bytes(checked), 0xFFFF);
  const auto rows = decode("mavlink", "\xFE" + body + static_cast<char>(crc & 0xFFU) + static_cast<char>(crc >> 8));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].at("name") == "COMMAND_ACK");
  CHECK(rows[0].at("f1") == "209");
}

TEST_CASE("MAVLink: an emulated vehicle acknowledges motor tests and keeps the pilot's sticks for three seconds") {
  devices::mavlink::Writer station{255, 190};
  devices::EmulatedAnswers vehicle{"mavlink"};
  vehicle.at(0.0);
  CHECK(vehicle.sticks() == nullptr);
  const auto answers =
      decode("mavlink", vehicle.hear(station.motor_test(3, 1620.4, 0.5, 1) + station.motor_test(99, 1620.0, 0.5, 1)));
  REQUIRE(answers.size() == 2);
  CHECK(answers[0].at("name") == "COMMAND_ACK");
  CHECK(answers[0].at("f1") == "209");
  CHECK(answers[0].at("f2") == "0");
  CHECK(answers[1].at("f2") == "4");  // there is no such motor
  CHECK(vehicle.applied()[3] == 1620.0);
  CHECK(vehicle.hear(station.rc_override({1500, 1510, 1460, 1300, 1700, 2000, 65535, 65535}, 1)).empty());
  REQUIRE(vehicle.sticks() != nullptr);
  CHECK(*vehicle.sticks() == std::array<double, 6>{0.0, 0.025, -0.1, -0.5, 0.5, 1.0});
  (void)vehicle.hear(station.rc_override({1500, 1510, 1460, 1300, 65535, 1500, 65535, 65535}, 1));
  CHECK((*vehicle.sticks())[4] == 0.5);  // left alone
  vehicle.at(2.9);
  CHECK(vehicle.sticks() != nullptr);
  vehicle.at(3.1);
  CHECK(vehicle.sticks() == nullptr);
}

TEST_CASE("thrusters' text: what is sent, what a rig applies and what it says") {
  const std::vector<double> pwm{1500, 1612.4, 1388};
  const std::string sentence = devices::thruster_sentence(pwm);
  CHECK(sentence.starts_with("$FTPWM,1500,1612,1388*"));
  devices::EmulatedAnswers rig{"thruster_text"};
  (void)rig.hear(sentence);
  CHECK(rig.applied() == std::vector<double>{1500, 1612, 1388});
  rig.at(0.4);
  CHECK(rig.applied()[1] == 1612);
  rig.at(0.6);  // nobody speaks any more
  CHECK(rig.applied()[1] == 1500);
  const auto rows = decode("thruster_text", devices::detail::nmea_sentence("FTBAT,15.8"));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].value("SI voltage [V]") == 15.8);
}

TEST_CASE("thrusters' text: a rig that regulates forces") {
  const std::vector<double> force{3.25, -1.1004, 0.0};
  const std::string sentence = devices::force_sentence(force);
  CHECK(sentence.starts_with("$FTFRC,3.250,-1.100,0.000*"));
  devices::EmulatedAnswers rig{"thruster_text"};
  CHECK(rig.applied_force().empty());
  (void)rig.hear(sentence);
  CHECK(rig.applied_force() == std::vector<double>{3.25, -1.1, 0.0});
  rig.at(0.6);  // nobody speaks any more
  CHECK(rig.applied_force() == std::vector<double>{0.0, 0.0, 0.0});
  class Told final : public devices::Output {
   public:
    void frame(const devices::Parser&, const devices::Frame& frame) override {
      if (const auto* one = std::get_if<const Thrusters*>(&frame.sample)) samples.push_back(**one);
    }
    std::vector<Thrusters> samples;
  } told;
  devices::ThrusterText parser{{.motors = 2}};
  parser.feed(devices::as_bytes(devices::detail::nmea_sentence("FTAPF,-3.5,1.25") +
                                devices::detail::nmea_sentence("FTAPP,1500,1600") +
                                devices::detail::nmea_sentence("FTAPF,1,2,3")),
              told);
  REQUIRE(told.samples.size() == 2);
  CHECK(told.samples[0].force == std::vector<double>{-3.5, 1.25});
  CHECK(told.samples[0].pwm_us.empty());
  CHECK(told.samples[1].pwm_us == std::vector<double>{1500, 1600});
  CHECK(parser.complaint().find("number of thrusters") != std::string::npos);
}
