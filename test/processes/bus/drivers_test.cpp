// Byte-true through the drivers: an emulated instrument at a real pseudo-terminal or socket, the driver as a process,
// and LCM messages that equal what the parser alone makes of the same bytes.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"
#include "common/devices/dialogue.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/link/server.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/bus.hpp"
#include "test/support/channels.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"
#include "test/support/wire_data.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::program;
using test::Scratch;
using test::shell;

// One emulated instrument and its driver.
struct Chain {
  std::string driver, protocol;
  bool tcp;
  double period;
  std::string keys;  // of this kind
};

const std::vector<Chain>& chains() {
  static const std::string kMount = "  rotation: 0 0 0 deg\n";
  static const std::string kAxes = "  axes: teledyne\n  ship_is_level: false\n";
  static const std::string kShip = "  beacon: ''\n  sigma: 1 m\n  transceiver: {position: 0 0 0 m, heading: 0 deg}\n";
  static const std::string kDepth =
      "  water_density: 1000 kg/m^3\n  gravity: 9.81 m/s^2\n  air_pressure: 101325 Pa\n  pressure: gauge\n";
  static const std::vector<Chain> kAll{
      {"ahrs_driver", "ig500", false, 0.01, kMount},
      {"ahrs_driver", "vn100", true, 0.01, kMount},
      {"ahrs_driver", "sbg_ecom", false, 0.02, kMount},
      {"ahrs_driver", "gx3", true, 0.02, kMount},
      {"ahrs_driver", "nmea_attitude", false, 0.1, kMount},
      {"dvl_driver", "pd0", false, 0.125, kMount},
      {"dvl_driver", "pd4", true, 0.125, kMount + kAxes},
      {"dvl_driver", "pd6", false, 0.125, kMount + kAxes + "  velocity: ship\n"},
      {"dvl_driver", "wl_serial", false, 0.125, kMount},
      {"dvl_driver", "wl_json", true, 0.125, kMount},
      {"usbl_driver", "nmea_usbl", true, 0.1, kShip},
      {"usbl_driver", "evologics", false, 0.1, kShip},
      {"range_driver", "psimlbm", false, 0.1, "  transponders: [r1, r2, r3, r4, r5]\n  sound_speed: 1500 m/s\n"},
      {"range_driver", "range_text", true, 0.1, "  transponders: [r1, r2, r3, r4, r5]\n"},
      {"depth_driver", "nmea_depth", false, 0.1, kDepth},
      {"load_driver", "load_text", true, 0.1, "  cells: [{name: load, gain: 1 N, zero: 0}]\n"},
  };
  return kAll;
}

const Chain& chain_of(const std::string& protocol) {
  return *std::find_if(chains().begin(), chains().end(), [&](const Chain& c) { return c.protocol == protocol; });
}

void configure(const Chain& chain, const std::string& link, const std::string& path, const std::string& record) {
  std::ofstream file{path};
  file << chain.driver << ":\n  protocol: " << chain.protocol << "\n  link: " << link << "\n  period: " << chain.period
       << " s\n  latency: 2 ms\n"
       << chain.keys;
  if (!record.empty()) file << "  record: " << record << "\n";
}

// Samples of the one stream that this chain fills, as text to be compared, times apart.
struct Told {
  std::vector<std::string> values;
  std::vector<Utime> times;
};

std::string text(const std::vector<double>& numbers) {
  std::string line;
  for (const double each : numbers) line += std::to_string(each) + " ";
  return line;
}

Told read(const std::string& path) {
  const Recording recording = wire::read_log(path).recording;
  Told told;
  const auto add = [&](Utime utime, const std::vector<double>& numbers) {
    told.values.push_back(text(numbers));
    told.times.push_back(utime);
  };
  for (const Ahrs& s : recording.ahrs) {
    const Eigen::Vector4d q = s.has_attitude ? s.q_WB.coeffs() : Eigen::Vector4d::Zero().eval();  // scalar last
    add(s.utime, {s.w_WB_B.x(), s.w_WB_B.y(), s.w_WB_B.z(), s.f_B.x(), s.f_B.y(), s.f_B.z(), q[3], q[0], q[1], q[2]});
  }
  for (const Dvl& s : recording.dvl) {
    add(s.utime, {s.v_WB_B.x(), s.v_WB_B.y(), s.v_WB_B.z(), s.altitude, s.valid ? 1.0 : 0.0});
  }
  for (const Usbl& s : recording.usbl) {
    add(s.utime, {s.p_WB.x(), s.p_WB.y(), s.p_WB.z(), s.sigma.x(), s.valid ? 1.0 : 0.0});
  }
  for (const Ranges& s : recording.ranges) add(s.utime, s.range);
  for (const Depth& s : recording.depth) add(s.utime, {s.z});
  for (const Loads& s : recording.loads) add(s.utime, s.load);
  return told;
}

// The same of the bytes that the emulator sent, by the parser alone.
std::vector<std::string> parsed(const Chain& chain, const std::string& bytes) {
  const devices::Protocol& protocol = devices::protocol(chain.protocol, "test");
  devices::Settings settings;
  if (chain.driver == "range_driver") settings.transponders = {"r1", "r2", "r3", "r4", "r5"};
  const auto parser = protocol.make(settings);
  std::vector<std::string> values;
  for (const test::WireRow& row : test::decode_wire(*parser, protocol, settings, bytes)) {
    if (!row.has_sample) continue;
    std::vector<double> numbers;
    for (const auto& [name, value] : row.fields) {
      if (name.starts_with("SI ")) numbers.push_back(value.empty() ? 0.0 : std::stod(value));
    }
    values.push_back(text(numbers));
  }
  return values;
}

// The first `unsettled` samples may differ: a parser that begins later in the stream learns later what comes in pairs.
bool is_tail(const std::vector<std::string>& tail, const std::vector<std::string>& whole, std::size_t unsettled = 0) {
  const std::size_t compared = tail.size() - std::min(unsettled, tail.size());
  return compared <= whole.size() &&
         std::equal(tail.rbegin(), tail.rbegin() + static_cast<std::ptrdiff_t>(compared), whole.rbegin());
}

}  // namespace

TEST_CASE("drivers: emulator, line, driver, LCM: the same samples as the parser makes of the bytes") {
  constexpr std::size_t kMissed = 4;  // samples that may come before the driver trusts the instrument
  const Scratch scratch;
  std::string script;
  const int port = 21000 + getpid() % 10000;
  for (std::size_t i = 0; i < chains().size(); ++i) {
    const Chain& chain = chains()[i];
    const std::string base = scratch.path(chain.protocol);
    const std::string tcp = std::to_string(port + static_cast<int>(i));
    configure(chain, chain.tcp ? "tcp://127.0.0.1:" + tcp : "serial://" + base + ".tty?baud=115200", base + ".yaml",
              base + ".raw");
    script += program("fathom") + " emulate " + chain.protocol + " --seconds " + std::to_string(4 * test::kPatience) +
              " --rate " + std::to_string(static_cast<int>(1.0 / chain.period)) + " --to " +
              (chain.tcp ? "tcp:" + tcp : "pty:" + base + ".tty") + " --sent " + base + ".sent > " + base +
              ".emulator &\nsleep 0.05\ntimeout -s INT " + std::to_string(6 * test::kPatience) + " " +
              program(chain.driver) + " --log-level warning --config " + base + ".yaml --out file://" + base +
              ".lcmlog > " + base + ".text 2>&1 &\n";
  }
  CHECK(shell(script + "wait").code == 0);
  for (const Chain& chain : chains()) {
    CAPTURE(chain.protocol);
    const std::string base = scratch.path(chain.protocol);
    CAPTURE(test::read_bytes(base + ".text"));
    const auto wanted = parsed(chain, test::read_bytes(base + ".sent"));
    const Told told = read(base + ".lcmlog");
    CHECK(told.values.size() > 2.0 / chain.period);
    CHECK(told.values.size() + kMissed >= wanted.size());
    CHECK(is_tail(told.values, wanted, kMissed));
    CHECK(std::is_sorted(told.times.begin(), told.times.end()));

    // The raw bytes that the driver recorded, parsed again by the driver: the same messages at the same times.
    configure(chain, "file://" + base + ".raw", base + ".again.yaml", "");
    const auto again = shell(program(chain.driver) + " --log-level warning --config " + base +
                             ".again.yaml --out file://" + base + ".again.lcmlog");
    CHECK_MESSAGE(again.code == 0, again.text);
    const Told twice = read(base + ".again.lcmlog");
    CHECK(is_tail(told.values, twice.values));
    if (chain.protocol != "ig500") CHECK(twice.times == told.times);
  }

  // An instrument away from the origin needs the attitude of that time: from the log, while its bytes are parsed again.
  const auto again = [&](const std::string& position, const std::string& in) {
    Chain away = chain_of("pd0");
    away.keys += position;
    configure(away, "file://" + scratch.path("pd0.raw"), scratch.path("away.yaml"), "");
    const std::string log = scratch.path("away" + std::to_string(position.size()) + ".lcmlog");
    const auto ran = shell(program("dvl_driver") + " --log-level warning --config " + scratch.path("away.yaml") + in +
                           " --out file://" + log);
    CHECK_MESSAGE(ran.code == 0, ran.text);
    return wire::read_log(log).recording.dvl;
  };
  const auto at_origin = again("", "");
  const auto ahead = again("  position: 0.5 0 0 m\n", " --in file://" + scratch.path("ig500.lcmlog"));
  REQUIRE(ahead.size() == at_origin.size());
  const auto attitudes = wire::read_log(scratch.path("ig500.lcmlog")).recording.ahrs;
  REQUIRE_FALSE(attitudes.empty());
  std::size_t corrected = 0, unaided = 0;
  for (std::size_t i = 0; i < ahead.size(); ++i) {
    CHECK(ahead[i].utime == at_origin[i].utime);
    // Configured later, or switched off earlier, than the velocity log: half a second is what lever_arm.hpp promises.
    const bool aided = std::any_of(attitudes.begin(), attitudes.end(), [&](const Ahrs& each) {
      return each.has_rates && std::abs(seconds_between(each.utime, ahead[i].utime)) <= 0.5;
    });
    unaided += aided ? 0 : 1;
    if (!ahead[i].valid) continue;
    ++corrected;
    // The emulated vehicle turns at 0.1 rad/s: half a metre ahead the bow goes 5 cm/s to starboard.
    CHECK(at_origin[i].v_WB_B.y() - ahead[i].v_WB_B.y() == doctest::Approx(0.05).epsilon(0.02));
  }
  // At the sanitizers' pace the two instruments do not begin and end together.
  const std::size_t missed = test::kTimed ? 2 : std::max<std::size_t>(unaided, 2);
  CHECK(corrected + missed >= ahead.size());

  // A compass's declination turns the heading, and nothing else.
  Chain compass = chain_of("ig500");
  compass.keys += "  heading_offset: 10 deg\n";
  configure(compass, "file://" + scratch.path("ig500.raw"), scratch.path("compass.yaml"), "");
  const auto ran = shell(program("ahrs_driver") + " --log-level warning --config " + scratch.path("compass.yaml") +
                         " --out file://" + scratch.path("compass.lcmlog"));
  CHECK_MESSAGE(ran.code == 0, ran.text);
  const auto turned = wire::read_log(scratch.path("compass.lcmlog")).recording.ahrs;
  const auto plain = wire::read_log(scratch.path("ig500.again.lcmlog")).recording.ahrs;
  REQUIRE(turned.size() == plain.size());
  REQUIRE_FALSE(turned.empty());
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const Eigen::Vector3d angles = euler_from_rotation(turned[i].q_WB.toRotationMatrix());
    const Eigen::Vector3d before = euler_from_rotation(plain[i].q_WB.toRotationMatrix());
    CHECK(wrap_angle(angles.z() - before.z()) == doctest::Approx(10.0 * std::numbers::pi / 180.0));
    CHECK((angles - before).head<2>().norm() < 1e-9);
    CHECK(turned[i].w_WB_B == plain[i].w_WB_B);
  }
}

TEST_CASE("drivers: a recording that is played waits for its driver, and arrives whole at the line's pace") {
  const Scratch scratch;
  const Chain chain = chain_of("pd0");
  configure(chain, "serial://" + scratch.path("tty") + "?baud=115200", scratch.path("x.yaml"), "");
  const auto ran =
      shell("timeout -s INT 6 " + program(chain.driver) + " --log-level warning --config " + scratch.path("x.yaml") +
            " --out file://" + scratch.path("x.lcmlog") + " 2> " + scratch.path("text") + " &\nsleep 0.3\n" +
            program("fathom") + " emulate pd0 --to pty:" + scratch.path("tty") + " --file " +
            test::file("test/data/wire/pd0_auv_dvl_short/") + "adcp_auv_51.pd0\nwait");
  CHECK_MESSAGE(ran.code == 0, ran.text);
  CHECK(wire::read_log(scratch.path("x.lcmlog")).recording.dvl.size() == 51);
}

TEST_CASE("drivers: with the example's configuration each hears and says what docs/messages.md tells, and starts") {
  const Scratch scratch;
  const std::string config = " --log-level error --config " + test::file("config/drivers/example.yaml") + " --config " +
                             test::file("config/vehicles/bluerov2.yaml") + " --config " +
                             test::file("config/operators/simulated.yaml");
  std::string script;
  const std::vector<std::string> drivers{"ahrs_driver",  "dvl_driver",  "usbl_driver",    "range_driver",
                                         "depth_driver", "load_driver", "thruster_driver"};
  for (const std::string& driver : drivers) {
    CAPTURE(driver);
    const auto ran = shell(program(driver) + config + " --interface");
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    const test::Channels actual = test::channels_of(ran.text);
    const test::Channels stated = test::channels_in_docs(driver);
    CHECK(actual.hears == stated.hears);
    CHECK(actual.says == stated.says);
    // Without its instrument a driver stays up until it is told to end; every key of its section is read.
    script += "timeout -s INT --preserve-status 3 " + program(driver) + config + " --out file://" +
              scratch.path(driver) + " || echo " + driver + " failed &\n";
  }
  const auto ran = shell(script + "wait");
  CHECK_MESSAGE(ran.text.empty(), ran.text);
}

TEST_CASE("drivers: bad configuration is refused with one line") {
  const Scratch scratch;
  Chain chain = chain_of("pd0");
  const auto complain = [&](const std::string& link) {
    configure(chain, link, scratch.path("x.yaml"), "");
    auto ran = shell(program(chain.driver) + " --config " + scratch.path("x.yaml") + " --out file://" +
                     scratch.path("x.lcmlog"));
    CHECK(ran.code == 1);
    CHECK(ran.lines() == 1);
    return ran;
  };
  CHECK(complain("carrier://pigeon").says("unknown kind of link"));
  CHECK(complain("file://" + scratch.path("none")).says("cannot be read"));
  chain.protocol = "vn100";
  CHECK(complain("file:///dev/null").says("no protocol 'vn100'; known: pd0"));
}

TEST_CASE(
    "drivers: rubbish, silence and a line that goes are said as HEALTH within a second, and the process stays up") {
  const Scratch scratch;
  Bus bus;
  const Chain chain = chain_of("pd0");
  configure(chain, "serial://" + scratch.path("tty") + "?baud=9600", scratch.path("x.yaml"), "");
  const auto said = [&](const char* words) {
    return std::any_of(bus.health.begin(), bus.health.end(), [&](const auto& each) {
      return each.state == "unhealthy" && each.detail.find(words) != std::string::npos;
    });
  };
  const Background driver{scratch, "driver",
                          program(chain.driver) + " --config " + scratch.path("x.yaml") + " --in '" + bus.url + "'"};
  CHECK(bus.until([&] { return said("no such device"); }));
  {
    link::Server silent{"pty:" + scratch.path("tty")};
    CHECK(bus.until([&] { return said("silent"); }));
    const std::string rubbish = test::wire_bytes("gx3_short/20140313_191853.3dmgx3.log").substr(0, 2000);
    for (int i = 0; i < 300 && !said("rubbish only"); ++i) {
      silent.send(rubbish.substr(static_cast<std::size_t>(100 * (i % 20)), 100));
      bus.listen(0.1);
    }
    CHECK(said("rubbish only"));
    const std::string good = test::wire_bytes("pd0_auv_dvl_short/adcp_auv_51.pd0").substr(0, 432);
    const auto runs = [&] { return bus.health.back().state == "running"; };
    for (int i = 0; i < 300 && !runs(); ++i) {
      silent.send(good);
      bus.listen(0.1);
    }
    CHECK(runs());
  }
  CHECK(bus.until([&] { return bus.health.back().state == "unhealthy"; }));
}

TEST_CASE("drivers: an instrument that was switched off and on behind a line that stayed is configured anew") {
  const Scratch scratch;
  Bus bus;
  const Chain chain = chain_of("ig500");  // it waits to be configured
  link::Server line{"pty:" + scratch.path("tty")};
  configure(chain, "serial://" + scratch.path("tty") + "?baud=115200", scratch.path("x.yaml"), "");
  const Background driver{scratch, "driver",
                          program(chain.driver) + " --config " + scratch.path("x.yaml") + " --in '" + bus.url + "'"};
  const auto on_until_it_runs = [&] {
    constexpr double kSlow = 30.0;  // s, of a busy machine
    devices::EmulatedAnswers instrument{chain.protocol};
    for (double t = 0.0; t < kSlow && (bus.health.empty() || bus.health.back().state != "running"); t += chain.period) {
      line.send(instrument.hear(line.wait(0.0)));
      if (instrument.sends_data()) {
        line.send(devices::emulate(chain.protocol, devices::emulated_motion(1.7e9 + t, t, {}), {}));
      }
      bus.listen(chain.period);
    }
    REQUIRE_FALSE(bus.health.empty());
    return bus.health.back();
  };
  CHECK(on_until_it_runs().state == "running");
  CHECK(bus.until([&] { return bus.health.back().detail.find("silent") != std::string::npos; }));
  const auto again = on_until_it_runs();
  CHECK_MESSAGE(again.state == "running", again.detail);
}

}  // namespace fathom
