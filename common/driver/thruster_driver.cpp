#include "common/driver/thruster_driver.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <optional>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/health_words.hpp"
#include "common/base/operator_key.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/thruster_text.hpp"
#include "common/driver/line_record.hpp"
#include "common/driver/thruster_gate.hpp"
#include "common/driver/vehicle_check.hpp"
#include "common/driver/watch.hpp"
#include "common/link/link.hpp"
#include "common/model/thruster_allocation.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "common/wire/signature.hpp"
#include "common/wire/vehicle.hpp"

namespace fathom::driver {
namespace {

constexpr double kStaleVoltage = 5.0;  // s
constexpr double kHeartbeat = 1.0;     // s between a ground station's signs of life
constexpr double kAnswer = 0.5;        // s between two words about what an order must quote
constexpr double kFeedback = 1.0;      // s: without newer feedback what was sent is told
constexpr double kTestLife = 0.5;      // s that one motor test may run on without the next
constexpr double kTellVehicle = 0.5;   // s between two of VEHICLE; a change is told at once
// Of the nominal voltage, where no floor is stated: 3.0 V of a lithium cell's 3.7 to 4.0, below which it takes harm.
constexpr double kFloorShare = 0.75;

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}
double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double positive(const Config& config, const std::string& key, const std::string& unit) {
  const double value = config.quantity(key, unit);
  if (!(value > 0.0)) config.fail(key, "'" + key + "' must be positive");
  return value;
}

enum class Way { kDryRun, kText, kMotorTest, kRcOverride };

Way way_of(const Config& config) {
  const std::string name = config.text("protocol");
  if (name == "dry_run") return Way::kDryRun;
  if (name == "text") return Way::kText;
  if (name == "motor_test") return Way::kMotorTest;
  if (name == "rc_override") return Way::kRcOverride;
  config.fail("protocol", "no protocol '" + name + "'; known: rc_override, motor_test, text, dry_run");
}

VehicleCheck::Expected expected(const Config& config, const model::Vehicle& vehicle, Way way) {
  VehicleCheck::Expected wanted;
  wanted.kind = way == Way::kDryRun ? VehicleCheck::Kind::kDryRun
                : way == Way::kText ? VehicleCheck::Kind::kRig
                                    : VehicleCheck::Kind::kArdusub;
  wanted.largest_thrust = positive(config, "largest_thrust", "N");
  wanted.must_report = way == Way::kRcOverride;
  wanted.voltage_floor =
      config.has("voltage_floor") ? config.not_negative("voltage_floor", "V") : kFloorShare * vehicle.nominal_voltage;
  // In MANUAL ArduSub adds nothing of its own, and does nothing by itself when the commands end.
  if (wanted.kind == VehicleCheck::Kind::kArdusub) wanted.modes = {"MANUAL"};
  if (config.has("modes")) wanted.modes = config.texts("modes");
  if (wanted.kind == VehicleCheck::Kind::kArdusub) wanted.system = std::clamp(config.integer("system"), 1, 255);
  return wanted;
}

class ThrusterDriver final : public devices::Output {
 public:
  ThrusterDriver(runtime::Process& process, const Config& config, const model::Vehicle& vehicle,
                 const OperatorKeys& keys)
      : process_{process},
        way_{way_of(config)},
        curved_{!vehicle.curve.empty()},
        allocation_{vehicle, positive(config, "largest_thrust", "N")},
        keys_{keys},
        gate_{unforeseeable()},
        period_{1.0 / positive(config, "rate", "Hz")},
        writer_{255, 190},
        check_{expected(config, vehicle, way_)} {
    if (!curved_ && way_ != Way::kDryRun && way_ != Way::kText) {
      config.fail("protocol", "'" + config.text("protocol") + "' sends pulse widths, and vehicle " + vehicle.name +
                                  " has no 'thrust_curve'; add it to its file, or send forces to a rig with 'text'");
    }
    if (way_ == Way::kDryRun) return;
    devices::Settings settings;
    settings.motors = allocation_.count();
    if (way_ == Way::kText) {
      parser_ = std::make_unique<devices::ThrusterText>(settings);
    } else {
      parser_ = std::make_unique<devices::Mavlink>(settings);
      target_ = static_cast<std::uint8_t>(std::clamp(config.integer("system"), 1, 255));
    }
    if (way_ == Way::kRcOverride) {
      const Config full = config.section("full_stick");
      constexpr std::array kAxes{"X", "Y", "Z", "K", "M", "N"};
      for (std::size_t i = 0; i < 6; ++i) full_stick_[i] = positive(full, kAxes[i], i < 3 ? "N" : "N m");
    }
    watch_.emplace(1.0, config.text("protocol"));
    record_.emplace(process, config);
    link_ = std::make_unique<link::Link>(
        link::Endpoint::parse(config.text("link"), config.where("link")),
        [this](std::span<const std::uint8_t> bytes, Utime arrival) {
          arrival_ = arrival;
          record_->write(bytes, arrival);
          watch_->bytes(bytes.size(), steady_seconds());
          parser_->feed(bytes, *this);
        },
        [this](bool up, const std::string& why) {
          parser_->restart();
          check_.restart(steady_seconds());
          watch_->link(up, why, steady_seconds());
        });
  }

  void hear(const WrenchCommand& command) { gate_.hear(command, wall_clock()); }
  void hear(const Operator& order) {
    const Answer answer = gate_.hear(order, wall_clock());
    if (order.abort) step(steady_seconds());  // at once
    say(answer);
  }
  void hear(const Answer& said) {
    const Utime now = wall_clock();
    if (gate_.hear(said, now)) say(gate_.answer(now));
  }

  void wait(std::span<const int> descriptors, int milliseconds) {
    const double left = std::max(0.0, next_ - steady_seconds());
    const int limit = std::min(milliseconds, static_cast<int>(std::ceil(1e3 * left)));
    if (link_) {
      link_->wait(descriptors, limit);
    } else {
      std::vector<pollfd> watched;
      for (const int each : descriptors) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
      poll(watched.data(), watched.size(), limit);
    }
    const double now = steady_seconds();
    if (now < next_) return;
    next_ = std::max(next_ + period_, now);
    step(now);
    say();
    if (now - answered_at_ >= kAnswer) {
      answered_at_ = now;
      say(gate_.answer(wall_clock()));
    }
    if (now - vehicle_told_at_ >= kTellVehicle) tell_vehicle(now);
  }

  /// The thrusters stand still before the driver goes.
  void end() {
    const model::Allocated still = allocation_.neutral();
    for (int i = 0; i < 3 && link_; ++i) {
      send(still, Vector6d::Zero(), steady_seconds());
      link_->wait({}, 20);
    }
    tell(still, wall_clock());
  }

  [[nodiscard]] runtime::Process::Condition condition() const {
    std::string unhealthy;
    const double now = steady_seconds();
    const Utime utime = wall_clock();
    // A line that says nothing at all is the first thing to see to, then what the vehicle says.
    if (watch_) {
      const std::string trouble = first_trouble(check_.condition(utime, now));
      const bool silent = watch_->silent(now);
      unhealthy = watch_->unhealthy(now, silent ? "" : trouble, parser_->complaint());
    }
    if (unhealthy.empty()) unhealthy = lacking_;
    if (unhealthy.empty() && gate_.ignores(utime)) unhealthy = std::string{kNotArmedYet} + "; arm again";
    const std::string_view reason = gate_.reason(utime);
    std::string detail = reason.empty() ? "thrust as commanded" : "zero thrust: " + std::string{reason};
    if (gate_.refused() > 0) {
      detail += ", orders refused " + std::to_string(gate_.refused()) + " (" + std::string{gate_.refusal()} + ")";
    }
    if (const std::string forged = gate_.forgeries(); !forged.empty()) detail += ", " + forged;
    if (keys_.known_to_all) detail += ", armed by a key that everybody knows";
    if (gate_.hears_stranger(utime)) detail += std::string(", ") + ThrusterGate::kStranger;
    if (parser_) detail += ", " + counts(*parser_, *watch_, *link_);
    return {.unhealthy = unhealthy, .detail = detail};
  }

  void frame(const devices::Parser& parser, const devices::Frame& frame) override {
    const double now = steady_seconds();
    watch_->frame(now);
    if (const auto* packet = dynamic_cast<const devices::Mavlink*>(&parser)) check_.hear(*packet, now);
    if (const auto* sentence = dynamic_cast<const devices::ThrusterText*>(&parser)) check_.hear(*sentence, now);
    if (const auto* battery = std::get_if<const Battery*>(&frame.sample)) {
      voltage_ = (*battery)->voltage;
      voltage_at_ = now;
      check_.hear_voltage(voltage_, now);
      watch_->sample(arrival_, now);
      Battery sample = **battery;
      sample.utime = arrival_;
      process_.publish(wire::kBattery, wire::encode(sample));
    }
    if (const auto* thrusters = std::get_if<const Thrusters*>(&frame.sample)) {
      const bool pulses = !(*thrusters)->pwm_us.empty();
      if (pulses && !curved_) return;  // nobody knows what they give
      watch_->sample(arrival_, now);
      feedback_at_ = now;
      const model::Allocated applied = pulses ? allocation_.applied((*thrusters)->pwm_us, voltage(now))
                                              : allocation_.applied_forces((*thrusters)->force);
      check_.applied(applied, now);
      tell(applied, arrival_);
    }
  }

 private:
  [[nodiscard]] double voltage(double now) const { return now - voltage_at_ < kStaleVoltage ? voltage_ : 0.0; }

  void step(double now) {
    const Utime utime = wall_clock();
    const Vector6d tau = gate_.wrench(utime);
    const model::Allocated allocated =
        gate_.reason(utime).empty() ? allocation_.allocate(tau, voltage(now)) : allocation_.neutral();
    lacking_ = allocation_.complaint(allocated);
    check_.asked(allocated, now);
    send(allocated, tau * allocated.scale, now);
    const bool reported = now - feedback_at_ < kFeedback;  // what the vehicle says it applied counts more
    if (!reported && way_ != Way::kRcOverride) tell(allocated, utime);
  }

  void send(const model::Allocated& allocated, const Vector6d& tau, double now) {
    if (!link_) return;
    if (way_ == Way::kText) {
      link_->send(curved_ ? devices::thruster_sentence(allocated.pwm_us) : devices::force_sentence(allocated.force));
      return;
    }
    if (now - heartbeat_at_ >= kHeartbeat) {
      heartbeat_at_ = now;
      link_->send(writer_.heartbeat());
    }
    if (way_ == Way::kRcOverride) {
      link_->send(writer_.rc_override(sticks(tau), target_));
      return;
    }
    std::string packets;
    for (std::size_t i = 0; i < allocated.pwm_us.size(); ++i) {
      packets += writer_.motor_test(i, allocated.pwm_us[i], kTestLife, target_);
    }
    link_->send(packets);
  }

  // Pilot's channels of ArduSub: pitch, roll, throttle (up), yaw, forward, lateral. It allocates by itself.
  [[nodiscard]] std::array<std::uint16_t, 8> sticks(const Vector6d& tau) const {
    constexpr double kMiddle = 1500.0, kThrow = 400.0;
    const auto stick = [&](Eigen::Index axis, double sign) {
      const double part = std::clamp(tau(axis) / full_stick_[static_cast<std::size_t>(axis)], -1.0, 1.0);
      return static_cast<std::uint16_t>(std::lround(kMiddle + sign * kThrow * part));
    };
    constexpr std::uint16_t kAlone = 65535;
    return {stick(4, 1.0), stick(3, 1.0), stick(2, -1.0), stick(5, 1.0), stick(0, 1.0), stick(1, 1.0), kAlone, kAlone};
  }

  void tell(const model::Allocated& allocated, Utime utime) {
    Thrusters sample{.utime = utime, .pwm_us = allocated.pwm_us, .force = allocated.force, .has_tau = true};
    std::copy(allocated.tau.begin(), allocated.tau.end(), sample.tau.begin());
    process_.publish(wire::kThrusters, wire::encode(sample));
  }

  void say(Answer answer) {
    answer.process = "thruster_driver";
    process_.publish(wire::kAnswer, wire::encode_signed(answer, keys_.answer));
  }

  void tell_vehicle(double now) {
    vehicle_told_at_ = now;
    process_.publish(wire::kVehicle, wire::encode(check_.condition(wall_clock(), now)));
  }

  // A change of what the driver does is said at once.
  void say() {
    const runtime::Process::Condition now = condition();
    const std::string kind = now.unhealthy.substr(0, now.unhealthy.find(':')) +
                             std::string{gate_.reason(wall_clock())} +
                             (gate_.hears_stranger(wall_clock()) ? ThrusterGate::kStranger : "") +
                             (gate_.hears_forgeries(wall_clock()) ? "forged" : "");
    if (kind == said_) return;
    said_ = kind;
    if (gate_.hears_forgeries(wall_clock())) process_.log_warning(gate_.forgeries());
    if (now.unhealthy.empty()) {
      process_.log_info(now.detail);
    } else {
      process_.log_warning(now.unhealthy);
    }
    process_.tell_health();
    tell_vehicle(steady_seconds());
  }

  runtime::Process& process_;
  Way way_;
  bool curved_;  ///< the vehicle has a thrust curve: pulse widths are sent, else forces
  model::ThrusterAllocation allocation_;
  OperatorKeys keys_;
  ThrusterGate gate_;
  double period_, next_{};
  std::uint8_t target_{1};
  std::array<double, 6> full_stick_{};
  devices::mavlink::Writer writer_;
  std::unique_ptr<devices::Parser> parser_;
  std::optional<Watch> watch_;
  std::optional<LineRecord> record_;
  VehicleCheck check_;
  double vehicle_told_at_{-1e9};
  Utime arrival_{};
  double voltage_{}, voltage_at_{-1e9}, feedback_at_{-1e9}, heartbeat_at_{-1e9}, answered_at_{-1e9};
  std::string lacking_;  ///< what was commanded and the thrusters cannot give
  std::string said_{"?"};
  std::unique_ptr<link::Link> link_;  // last: its handlers use the others
};

}  // namespace

int thruster_main(int argc, const char* const* argv) {
  const runtime::Program program{"thruster_driver", "Drives the thrusters as the supervisor asks, once armed."};
  return runtime::main(program, argc, argv, [](runtime::Process& process) {
    const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
    const OperatorKeys keys = operator_keys(process.config_path("operator"));
    ThrusterDriver driver{process, process.config(), vehicle, keys};
    process.publishes<fathom_lcm::thrusters_t>(wire::kThrusters);
    process.publishes<fathom_lcm::battery_t>(wire::kBattery);
    process.publishes<fathom_lcm::answer_t>(wire::kAnswer);
    process.publishes<fathom_lcm::vehicle_condition_t>(wire::kVehicle);
    process.on<fathom_lcm::wrench_command_t>(
        wire::kWrenchCommand, [&](const auto& message) { return wire::open(message, keys.command); },
        [&](const WrenchCommand& command) { driver.hear(command); });
    process.on<fathom_lcm::operator_t>(
        wire::kOperator, [&](const auto& message) { return wire::open(message, keys.order); },
        [&](const Operator& order) { driver.hear(order); });
    process.listens_to<fathom_lcm::answer_t>(wire::kAnswer, [&](const auto& message) {
      if (const auto answer = wire::open(message, keys.answer)) driver.hear(*answer);
    });
    process.waits_with(
        [&](std::span<const int> descriptors, int milliseconds) { driver.wait(descriptors, milliseconds); });
    process.on_health([&] { return driver.condition(); });
    process.on_end([&] { driver.end(); });
    process.run();
  });
}

}  // namespace fathom::driver
