#include "processes/simulator/instruments.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/devices/attitude.hpp"
#include "common/devices/dialogue.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/protocols.hpp"
#include "common/link/endpoint.hpp"
#include "common/link/server.hpp"
#include "common/model/thruster_allocation.hpp"

namespace fathom::simulator {
namespace {

// Clocks of instruments: neither set to the host's time nor as fast.
constexpr double kSinceSwitchedOn = 60.0;  // s, of those that count from there
constexpr double kSetWrong = 0.4;          // s
constexpr double kDrift = 20e-6;

constexpr const char* kThrusters = "thruster_driver";

struct Carried {
  const char* sensor;   ///< of the simulation
  const char* section;  ///< of the drivers' file
};
constexpr std::array kCarried{Carried{"ahrs", "ahrs_driver"},   Carried{"dvl", "dvl_driver"},
                              Carried{"usbl", "usbl_driver"},   Carried{"ranges", "range_driver"},
                              Carried{"depth", "depth_driver"}, Carried{"loads", "load_driver"}};

std::string protocol_of(const Config& section) {
  std::string name = section.text("protocol");
  if (name == "text") return "thruster_text";
  if (name == "motor_test" || name == "rc_override") return "mavlink";
  if (name == "dry_run") section.fail("protocol", "dry_run moves nothing; use motor_test or text");
  if (name == "ms5837") section.fail("protocol", "ms5837 sits on a bus, which cannot be played; use nmea_depth");
  return name;
}

// The instrument's end of a driver's link.
std::string other_end(const Config& section) {
  const std::string text = section.text("link");
  const link::Endpoint end = link::Endpoint::parse(text, section.where("link"));
  if (end.kind == link::Endpoint::Kind::kSerial) return "pty:" + end.path;
  if (end.kind == link::Endpoint::Kind::kTcp && end.host == "127.0.0.1") return "tcp:" + std::to_string(end.port);
  section.fail("link", "'" + text + "' cannot be played here; write serial:///PATH?baud=N or tcp://127.0.0.1:PORT");
}

// Turned from the body's axes into those of an instrument.
Ahrs seen_by(const Ahrs& body, const Eigen::Matrix3d& R_BS) {
  Ahrs seen = body;
  seen.q_WB = body.q_WB * Eigen::Quaterniond{R_BS};
  seen.w_WB_B = R_BS.transpose() * body.w_WB_B;
  seen.f_B = R_BS.transpose() * body.f_B;
  return seen;
}

// What is told raw where there is a choice: along beams.
devices::EmulatedDvl dvl_of(const std::string& protocol, double beam_angle) {
  constexpr std::array kAngles{15.0, 20.0, 30.0};  // deg, that PD0 can name
  devices::EmulatedDvl dvl;
  if (protocol == "pd0") dvl.frame = devices::DvlFrame::kBeam;
  dvl.beam_angle_deg = *std::min_element(kAngles.begin(), kAngles.end(), [&](double a, double b) {
    return std::abs(a * devices::kRadians - beam_angle) < std::abs(b * devices::kRadians - beam_angle);
  });
  return dvl;
}

}  // namespace

struct Instruments::Line {
  Line(std::string driver, const Config& section, std::size_t motors)
      : name{std::move(driver)}, protocol{protocol_of(section)}, answers{protocol}, server{other_end(section)} {
    const devices::Protocol& known = devices::protocol(protocol, section.where("protocol"));
    settings = devices::read_settings(section, known);
    settings.motors = motors;
    counts_from_start = known.kind == devices::Kind::kAhrs;
  }
  [[nodiscard]] double clock(Utime origin, Utime utime) const {
    const double since = seconds_between(origin, utime) * (1.0 + kDrift);
    return since + (counts_from_start ? kSinceSwitchedOn : 1e-6 * static_cast<double>(origin) + kSetWrong);
  }

  std::string name, protocol;
  devices::Settings settings;
  devices::EmulatedAnswers answers;
  link::Server server;
  bool counts_from_start{};
};

// A simulated ArduSub: what the pilot's sticks ask for, to pulse widths, by the vehicle file and without its battery.
class Instruments::Autopilot {
 public:
  Autopilot(const Config& section, const model::Vehicle& vehicle)
      : allocation_{vehicle, section.quantity("largest_thrust", "N")} {
    const Config full = section.section("full_stick");
    constexpr std::array kAxes{"X", "Y", "Z", "K", "M", "N"};
    for (Eigen::Index i = 0; i < 6; ++i) {
      full_stick_(i) = full.quantity(kAxes[static_cast<std::size_t>(i)], i < 3 ? "N" : "N m");
    }
  }
  [[nodiscard]] std::vector<double> pulses(const std::array<double, 6>* sticks) const {
    if (sticks == nullptr) return allocation_.neutral().pwm_us;
    const auto [pitch, roll, throttle, yaw, forward, lateral] = *sticks;
    const Vector6d parts = (Vector6d{} << forward, lateral, -throttle, roll, pitch, yaw).finished();
    return allocation_.allocate(parts.cwiseProduct(full_stick_), 0.0).pwm_us;
  }

 private:
  model::ThrusterAllocation allocation_;
  Vector6d full_stick_{};
};

// One sample's way to its line.
struct Instruments::Speaker {
  Instruments& all;

  bool tell(const char* section, Utime utime, devices::Instant now, const devices::EmulatedDvl& dvl = {}) const {
    Line* line = all.line(section);
    if (line == nullptr) return false;
    now.time = line->clock(all.origin_, utime);
    if (line->answers.sends_data()) line->server.send(devices::emulate(line->protocol, now, line->settings, dvl));
    return true;
  }
  bool operator()(const Ahrs& sample) const {
    all.attitude_ = sample;
    return tell("ahrs_driver", sample.utime, {.ahrs = seen_by(sample, all.vehicle_->mounts.ahrs->R_BS)});
  }
  bool operator()(const Dvl& sample) const {
    Line* line = all.line("dvl_driver");
    if (line == nullptr) return false;
    const auto& mount = *all.vehicle_->mounts.dvl;
    devices::Instant now{.ahrs = seen_by(all.attitude_, mount.mount.R_BS), .dvl = sample};
    now.dvl.v_WB_B = mount.mount.R_BS.transpose() * sample.v_WB_B;
    return tell("dvl_driver", sample.utime, now, dvl_of(line->protocol, mount.beam_angle));
  }
  bool operator()(const Usbl& sample) const { return tell("usbl_driver", sample.utime, {.usbl = sample}); }
  bool operator()(const Depth& sample) const { return tell("depth_driver", sample.utime, {.depth = sample}); }
  bool operator()(const Ranges& sample) const { return tell("range_driver", sample.utime, {.ranges = sample}); }
  bool operator()(const Loads& sample) const { return tell("load_driver", sample.utime, {.loads = sample}); }
  bool operator()(const Battery& sample) const {
    if (all.rig_ != nullptr) all.voltage_ = sample.voltage;
    return all.rig_ != nullptr;
  }
  bool operator()(const Thrusters& sample) const {
    const bool told = tell(kThrusters, sample.utime, {.thrusters = sample, .voltage = all.voltage_});
    all.voltage_ = 0.0;
    return told;
  }
  template <class Other>
  bool operator()(const Other&) const {
    return false;
  }
};

Instruments::Instruments(const std::string& drivers, const model::Vehicle& vehicle,
                         const std::vector<std::string>& carried)
    : vehicle_{&vehicle} {
  const Config file = Config::load(drivers);
  const std::size_t motors = vehicle.thrusters.size();
  for (const Carried& each : kCarried) {
    const bool here = std::find(carried.begin(), carried.end(), each.sensor) != carried.end();
    if (here && file.has(each.section)) {
      lines_.push_back(std::make_unique<Line>(each.section, file.section(each.section), motors));
    }
  }
  if (file.has(kThrusters)) {
    lines_.push_back(std::make_unique<Line>(kThrusters, file.section(kThrusters), motors));
    rig_ = lines_.back().get();
    if (vehicle.curve.empty() && rig_->protocol != "thruster_text") {
      file.section(kThrusters).fail("protocol", "vehicle " + vehicle.name + " has no thrust curve; use text");
    }
    const Config section = file.section(kThrusters);
    if (section.text("protocol") == "rc_override") autopilot_ = std::make_unique<Autopilot>(section, vehicle);
  }
  if (lines_.empty()) throw InputError(drivers + ": no driver of an instrument that is carried here; see docs/live.md");
}

Instruments::~Instruments() = default;

Instruments::Line* Instruments::line(const char* section) const {
  const auto found =
      std::find_if(lines_.begin(), lines_.end(), [&](const auto& each) { return each->name == section; });
  return found != lines_.end() ? found->get() : nullptr;
}

std::string Instruments::absent() const {
  std::string names;
  for (const auto& each : lines_) {
    if (each->server.connected() && each->answers.sends_data()) continue;
    names += (names.empty() ? "" : ", ") + each->name + " at " + each->server.name();
  }
  return names;
}

void Instruments::serve(double now) {
  for (const auto& each : lines_) {
    each->answers.at(now);
    each->server.send(each->answers.hear(each->server.wait(0.0)));
  }
}

bool Instruments::say(const simulation::Sample& sample) { return std::visit(Speaker{*this}, sample); }

std::vector<double> Instruments::told() const {
  if (autopilot_) return autopilot_->pulses(rig_->answers.sticks());
  const bool pulses = !vehicle_->curve.empty();
  std::vector<double> told = pulses ? rig_->answers.applied() : rig_->answers.applied_force();
  told.resize(vehicle_->thrusters.size(), pulses ? vehicle_->curve.neutral_us : 0.0);
  return told;
}

}  // namespace fathom::simulator
