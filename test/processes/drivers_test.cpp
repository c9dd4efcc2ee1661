// Byte-true through the drivers: an emulated instrument at a real pseudo-terminal or socket, the driver as a process,
// and LCM messages that equal what the parser alone makes of the same bytes.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <thread>

#include "common/link/server.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/channels.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/wire_data.hpp"

namespace fathom {
namespace {

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
  static const std::string kShip = "  beacon: ''\n  sigma: 1 m\n  transceiver: {position: 0 0 0 m, heading: 0 deg}\n";
  static const std::string kDepth =
      "  water_density: 1000 kg/m^3\n  gravity: 9.81 m/s^2\n  air_pressure: 101325 Pa\n  pressure: gauge\n";
  static const std::vector<Chain> kAll{
      {"ahrs_driver", "ig500", false, 0.01, kMount},
      {"ahrs_driver", "vn100", true, 0.01, kMount},
      {"dvl_driver", "pd0", false, 0.125, kMount},
      {"dvl_driver", "wl_serial", false, 0.125, kMount},
      {"dvl_driver", "wl_json", true, 0.125, kMount},
      {"usbl_driver", "nmea_usbl", true, 0.1, kShip},
      {"range_driver", "psimlbm", false, 0.1, "  transponders: [a, b, c, d, e]\n  sound_speed: 1500 m/s\n"},
      {"depth_driver", "nmea_depth", false, 0.1, kDepth},
      {"load_driver", "load_text", true, 0.1, "  cells: [{name: load, gain: 1 N, zero: 0}]\n"},
  };
  return kAll;
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
    add(s.utime, {s.w_WB_B.x(), s.w_WB_B.y(), s.w_WB_B.z(), s.f_B.x(), s.f_B.y(), s.f_B.z(), s.q_WB.w(), s.q_WB.x(),
                  s.q_WB.y(), s.q_WB.z()});
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
  if (chain.protocol == "psimlbm") settings.transponders = {"a", "b", "c", "d", "e"};
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

bool is_tail(const std::vector<std::string>& tail, const std::vector<std::string>& whole) {
  return tail.size() <= whole.size() && std::equal(tail.rbegin(), tail.rend(), whole.rbegin());
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
    script += program("fathom") + " emulate " + chain.protocol + " --seconds 4 --rate " +
              std::to_string(static_cast<int>(1.0 / chain.period)) + " --to " +
              (chain.tcp ? "tcp:" + tcp : "pty:" + base + ".tty") + " --sent " + base + ".sent > " + base +
              ".emulator &\nsleep 0.05\ntimeout -s INT 6 " + program(chain.driver) + " --log-level warning --config " +
              base + ".yaml --out file://" + base + ".lcmlog > " + base + ".text 2>&1 &\n";
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
    CHECK(is_tail(told.values, wanted));
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
    script += "timeout -s INT --preserve-status 1 " + program(driver) + config + " --out file://" +
              scratch.path(driver) + " || echo " + driver + " failed &\n";
  }
  CHECK(shell(script + "wait").text.empty());
}

TEST_CASE("drivers: bad configuration is refused with one line") {
  const Scratch scratch;
  Chain chain = chains()[2];
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

namespace {

// Listens to a bus of its own in this thread.
class Bus {
 public:
  Bus() : url{"udpm://239.255.76.67:" + std::to_string(31000 + getpid() % 9000) + "?ttl=0"}, lcm_{url} {
    REQUIRE(lcm_.good());
    lcm_.subscribe("HEALTH", &Bus::on_health, this);
    lcm_.subscribe("THRUSTERS", &Bus::on_thrusters, this);
  }
  void listen(double seconds) {
    const double end = link::wall_seconds() + seconds;
    while (link::wall_seconds() < end) lcm_.handleTimeout(10);
  }
  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    lcm_.publish(channel, &message);
  }
  std::string url;
  std::vector<fathom_lcm::health_t> health;
  std::vector<fathom_lcm::thrusters_t> thrusters;

 private:
  void on_health(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::health_t* message) {
    health.push_back(*message);
  }
  void on_thrusters(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::thrusters_t* message) {
    thrusters.push_back(*message);
  }
  lcm::LCM lcm_;
};

// A program in the background that ends with the object.
class Background {
 public:
  Background(const Scratch& scratch, const std::string& name, const std::string& command)
      : pid_{scratch.path(name + ".pid")} {
    shell(command + " > " + scratch.path(name + ".text") + " 2>&1 & echo $! > " + pid_);
  }
  ~Background() { stop(); }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  void stop() const { shell("kill -INT $(cat " + pid_ + ") 2>/dev/null; sleep 0.3"); }

 private:
  std::string pid_;
};

Utime now() { return static_cast<Utime>(1e6 * link::wall_seconds()); }

}  // namespace

TEST_CASE(
    "drivers: rubbish, silence and a line that goes are said as HEALTH within a second, and the process stays up") {
  const Scratch scratch;
  Bus bus;
  const Chain chain = chains()[2];
  configure(chain, "serial://" + scratch.path("tty") + "?baud=9600", scratch.path("x.yaml"), "");
  const auto said = [&](const char* words) {
    return std::any_of(bus.health.begin(), bus.health.end(), [&](const auto& each) {
      return each.state == "unhealthy" && each.detail.find(words) != std::string::npos;
    });
  };
  const Background driver{scratch, "driver",
                          program(chain.driver) + " --config " + scratch.path("x.yaml") + " --in '" + bus.url + "'"};
  bus.listen(1.0);
  CHECK(said("no such device"));
  {
    link::Server silent{"pty:" + scratch.path("tty")};
    bus.listen(2.5);
    CHECK(said("silent"));
    const std::string rubbish = test::wire_bytes("gx3_short/20140313_191853.3dmgx3.log").substr(0, 2000);
    for (int i = 0; i < 20; ++i) {
      silent.send(rubbish.substr(static_cast<std::size_t>(100 * i), 100));
      bus.listen(0.1);
    }
    CHECK(said("rubbish only"));
    const std::string good = test::wire_bytes("pd0_auv_dvl_short/adcp_auv_51.pd0").substr(0, 432);
    bus.health.clear();
    for (int i = 0; i < 12; ++i) {
      silent.send(good);
      bus.listen(0.1);
    }
    CHECK(bus.health.back().state == "running");
  }
  bus.listen(1.0);
  CHECK(bus.health.back().state == "unhealthy");
}

namespace {

void arm(Bus& bus, const std::string& token) {
  fathom_lcm::operator_t order{};
  order.utime = now();
  order.enable = true;
  order.token = token;
  order.sequence = order.utime;
  bus.publish("OPERATOR", order);
}

}  // namespace

TEST_CASE(
    "thruster_driver: arms by token alone, obeys, goes to zero within half a second, hears an abort, and says what was "
    "applied") {
  for (const std::string protocol : {"text", "motor_test", "dry_run"}) {
    CAPTURE(protocol);
    const Scratch scratch;
    Bus bus;
    std::ofstream{scratch.path("x.yaml")}
        << "thruster_driver:\n  protocol: " << protocol << "\n  rate: 20 Hz\n  largest_thrust: 30 N\n"
        << (protocol == "dry_run" ? "" : "  link: serial://" + scratch.path("tty") + "?baud=115200\n")
        << (protocol == "motor_test" ? "  system: 1\n" : "");
    const Background rig{scratch, "rig",
                         program("fathom") + " emulate " + (protocol == "motor_test" ? "mavlink" : "thruster_text") +
                             " --to pty:" + scratch.path("tty")};
    const Background driver{
        scratch, "driver",
        program("thruster_driver") + " --config " + scratch.path("x.yaml") + " --config " +
            test::file(protocol == "text" ? "config/vehicles/beluga.yaml" : "config/vehicles/bluerov2.yaml") +
            " --config " + test::file("config/operators/simulated.yaml") + " --in '" + bus.url + "'"};
    bus.listen(1.5);
    CAPTURE(test::read_bytes(scratch.path("driver.text")));
    const auto thrust = [&] { return bus.thrusters.empty() ? -1.0 : bus.thrusters.back().tau[0]; };
    CHECK(thrust() == doctest::Approx(0.0));
    const auto command = [&](double seconds) {
      for (int i = 0; i < static_cast<int>(20 * seconds); ++i) {
        fathom_lcm::wrench_command_t message{};
        message.utime = now();
        message.tau[0] = 20.0;
        message.life = 0.5;
        bus.publish("WRENCH_COMMAND", message);
        bus.listen(0.05);
      }
    };
    command(0.7);
    CHECK(thrust() == doctest::Approx(0.0));  // nobody has armed
    arm(bus, "a guess");
    command(0.4);
    CHECK(thrust() == doctest::Approx(0.0));
    arm(bus, "only-for-simulation");
    command(1.0);
    CHECK(thrust() == doctest::Approx(20.0).epsilon(0.05));  // the rig rounds to a microsecond
    bus.listen(0.9);                                         // half a second, and the rig's next report
    CHECK(thrust() == doctest::Approx(0.0));
    command(0.7);
    CHECK(thrust() > 15.0);
    fathom_lcm::operator_t abort{};
    abort.utime = now();
    abort.abort = true;
    bus.publish("OPERATOR", abort);
    command(0.4);
    CHECK(thrust() == doctest::Approx(0.0));
  }
}

TEST_CASE("thruster_driver: RC override puts the wrench on the pilot's channels, and the middle when commands stop") {
  const Scratch scratch;
  Bus bus;
  link::Server vehicle{"pty:" + scratch.path("tty")};
  std::ofstream{scratch.path("x.yaml")}
      << "thruster_driver:\n  protocol: rc_override\n  rate: 20 Hz\n  largest_thrust: 30 N\n"
      << "  link: serial://" << scratch.path("tty") << "?baud=115200\n  system: 1\n"
      << "  full_stick: {X: 40 N, Y: 40 N, Z: 40 N, K: 4 N m, M: 4 N m, N: 4 N m}\n";
  const Background driver{scratch, "driver",
                          program("thruster_driver") + " --config " + scratch.path("x.yaml") + " --config " +
                              test::file("config/vehicles/bluerov2.yaml") + " --config " +
                              test::file("config/operators/simulated.yaml") + " --in '" + bus.url + "'"};
  bus.listen(1.5);
  arm(bus, "only-for-simulation");
  (void)vehicle.wait(0.1);
  std::string bytes;
  for (int i = 0; i < 20; ++i) {
    fathom_lcm::wrench_command_t message{};
    message.utime = now();
    message.tau[0] = 10.0;
    message.tau[2] = 5.0;   // down
    message.tau[5] = -0.4;  // to port
    message.life = 0.5;
    bus.publish("WRENCH_COMMAND", message);
    bus.listen(0.05);
    bytes += vehicle.wait(0.0);
  }
  const auto overrides = [](const std::string& stream) {
    const devices::Protocol& protocol = devices::protocol("mavlink", "test");
    const auto parser = protocol.make({});
    std::vector<test::WireRow> found;
    for (test::WireRow& row : test::decode_wire(*parser, protocol, {}, stream)) {
      if (row.at("msgid") == "70") found.push_back(std::move(row));
    }
    return found;
  };
  const auto obeyed = overrides(bytes);
  REQUIRE(obeyed.size() > 10);
  CHECK(obeyed.back().at("f5") == "1600");  // forward: a quarter of 400 us
  CHECK(obeyed.back().at("f3") == "1450");  // throttle is up
  CHECK(obeyed.back().at("f4") == "1460");  // yaw
  CHECK(obeyed.back().at("f6") == "1500");
  CHECK(bytes.find("\xFD\x09") != std::string::npos);  // a ground station's heartbeat of nine bytes
  bus.listen(0.7);
  (void)vehicle.wait(0.0);
  bus.listen(0.3);
  const auto stopped = overrides(vehicle.wait(0.1));
  REQUIRE_FALSE(stopped.empty());
  CHECK(stopped.back().at("f5") == "1500");
  CHECK(stopped.back().at("f3") == "1500");
}

}  // namespace fathom
