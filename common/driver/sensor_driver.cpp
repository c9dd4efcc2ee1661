#include "common/driver/sensor_driver.hpp"

#include <algorithm>
#include <chrono>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/loads_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/usbl_t.hpp>
#include <limits>
#include <memory>
#include <optional>

#include "common/devices/clock_map.hpp"
#include "common/devices/dialogue.hpp"
#include "common/driver/lever_arm.hpp"
#include "common/driver/line_record.hpp"
#include "common/driver/pressure_sensor.hpp"
#include "common/driver/watch.hpp"
#include "common/link/link.hpp"
#include "common/link/raw_log.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::driver {
namespace {

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double positive(const Config& config, const std::string& key, const std::string& unit) {
  const double value = config.quantity(key, unit);
  if (!(value > 0.0)) config.fail(key, "'" + key + "' must be positive");
  return value;
}

// Where those sit that measure at a point of their own.
Eigen::Vector3d place(const Config& config, devices::Kind kind) {
  const bool matters = kind == devices::Kind::kDvl || kind == devices::Kind::kUsbl || kind == devices::Kind::kDepth;
  return matters && config.has("position") ? config.vector3("position", "m") : Eigen::Vector3d::Zero().eval();
}

// From the north that an attitude sensor means to the world's: a compass's declination, or the way a tank lies.
std::optional<Eigen::Quaterniond> heading_offset(const Config& config, devices::Kind kind) {
  if (kind != devices::Kind::kAhrs || !config.has("heading_offset")) return {};
  return Eigen::Quaterniond{Eigen::AngleAxisd{config.quantity("heading_offset", "rad"), Eigen::Vector3d::UnitZ()}};
}

class SensorDriver final : public devices::Output {
 public:
  SensorDriver(runtime::Process& process, const Config& config, const devices::Protocol& protocol)
      : process_{process},
        parser_{protocol.make(devices::read_settings(config, protocol))},
        dialogue_{devices::make_dialogue(protocol.name, devices::read_settings(config, protocol))},
        clock_{config.quantity("latency", "s"), protocol.tick, protocol.turn},
        watch_{positive(config, "period", "s"), std::string{protocol.name}},
        arm_{place(config, protocol.kind)},
        q_WN_{heading_offset(config, protocol.kind)},
        record_{process, config},
        link_{link::Endpoint::parse(config.text("link"), config.where("link")),
              [this](std::span<const std::uint8_t> bytes, Utime arrival) { received(bytes, arrival); },
              [this](bool up, const std::string& why) { changed(up, why); }} {
    if (link_.endpoint().kind == link::Endpoint::Kind::kFile) {
      dialogue_.reset();  // nobody answers
      if (process_.reads_logs()) open_beside_log();
    }
    if (arm_.needed()) {
      process_.on<fathom_lcm::ahrs_t>(wire::kAhrs, wire::kDecode, [this](const Ahrs& sample) {
        arm_.hear(sample);
        replay(sample.utime);
      });
    }
    process_.waits_with(
        [this](std::span<const int> descriptors, int milliseconds) { wait(descriptors, milliseconds); });
    process_.on_health([this] { return condition(); });
    process_.on_end([this] {
      replay(std::numeric_limits<Utime>::max());
      process_.log_info(counts());
    });
  }

  void frame(const devices::Parser& parser, const devices::Frame& frame) override {
    const double now = steady_seconds();
    watch_.frame(now);
    if (dialogue_) {
      link_.send(dialogue_->hear(parser, frame, now));
      if (!dialogue_->done()) return;
    }
    if (frame.sample.index() == 0) return;
    const Utime utime = clock_.map(frame.device_time, arrival_);
    watch_.sample(utime, now);
    std::visit([&](const auto& sample) { publish(sample, utime); }, frame.sample);
  }

 private:
  void wait(std::span<const int> descriptors, int milliseconds) {
    link_.wait(descriptors, milliseconds);
    const double now = steady_seconds();
    if (dialogue_ && link_.up()) link_.send(speak(now));
    if (link_.finished()) {
      parser_->finish(*this);
      process_.stop();
      return;
    }
    say(condition().unhealthy);
  }

  // Whoever was configured and says nothing more may have been switched off and on: it is told anew.
  std::string speak(double now) {
    constexpr double kSilence = 1.0;  // s
    const bool forgot = dialogue_->done() && watch_.since_sample(now) > std::max(kSilence, watch_.patience());
    if (!forgot || now - told_ < kSilence) return dialogue_->tick(now);
    told_ = now;
    return dialogue_->begin(now);
  }

  // Recorded bytes beside a recorded bus: what had come when an attitude was true is parsed after it was heard.
  void open_beside_log() {
    const link::Endpoint& file = link_.endpoint();
    recording_.emplace(file.path, file.start, file.rate);
    piece_ = recording_->next();
    changed(true, "");
  }
  void replay(Utime until) {
    while (piece_ && piece_->utime <= until) {
      received(piece_->bytes, piece_->utime);
      piece_ = recording_->next();
    }
    if (recording_ && !piece_) parser_->finish(*this);
  }

  void received(std::span<const std::uint8_t> bytes, Utime arrival) {
    record_.write(bytes, arrival);
    arrival_ = arrival;
    watch_.bytes(bytes.size(), steady_seconds());
    parser_->feed(bytes, *this);
  }

  void changed(bool up, const std::string& why) {
    const double now = steady_seconds();
    watch_.link(up, why, now);
    parser_->restart();
    clock_.reset();
    if (up && dialogue_) link_.send(dialogue_->begin(now));
  }

  runtime::Process::Condition condition() {
    if (link_.finished()) return {};
    const std::string failure = dialogue_ ? dialogue_->failure() : std::string{};
    return {.unhealthy = watch_.unhealthy(steady_seconds(), failure, parser_->complaint()), .detail = counts()};
  }

  std::string counts() const {
    std::string text = driver::counts(*parser_, watch_, link_) + ", restarts " + std::to_string(clock_.restarts());
    if (const auto drift = clock_.drift()) text += ", clock " + std::to_string(std::lround(*drift)) + " ppm slow";
    if (!parser_->complaint().empty()) text += ", note: " + parser_->complaint();
    return text;
  }

  // A change of state is said at once, on stderr and as HEALTH.
  void say(const std::string& unhealthy) {
    const std::string kind = unhealthy.substr(0, unhealthy.find(':'));  // numbers behind it change all the time
    if (kind == said_) return;
    said_ = kind;
    if (unhealthy.empty()) {
      process_.log_info("well: measurements come");
    } else {
      process_.log_warning(unhealthy);
    }
    process_.tell_health();
  }

  void publish(std::monostate, Utime) {}
  void publish(const Ahrs* sample, Utime utime) {
    Ahrs in_world = *sample;
    if (in_world.has_attitude && q_WN_) in_world.q_WB = *q_WN_ * in_world.q_WB;
    send(wire::kAhrs, in_world, utime);
  }
  void publish(const Ranges* sample, Utime utime) { send(wire::kRanges, *sample, utime); }
  void publish(const Loads* sample, Utime utime) { send(wire::kLoads, *sample, utime); }
  void publish(const Battery*, Utime) {}    // these two come from
  void publish(const Thrusters*, Utime) {}  // thrusters only
  void publish(const Dvl* sample, Utime utime) {
    Dvl at_origin = *sample;
    at_origin.utime = utime;
    arm_.remove(at_origin);
    send(wire::kDvl, at_origin, utime);
  }
  void publish(const Usbl* sample, Utime utime) {
    Usbl at_origin = *sample;
    at_origin.utime = utime;
    arm_.remove(at_origin);
    send(wire::kUsbl, at_origin, utime);
  }
  void publish(const Depth* sample, Utime utime) {
    Depth at_origin = *sample;
    at_origin.utime = utime;
    arm_.remove(at_origin);
    send(wire::kDepth, at_origin, utime);
  }
  template <class T>
  void send(const char* channel, const T& sample, Utime utime) {
    auto message = wire::encode(sample);
    message.utime = utime;
    process_.publish(channel, message);
  }

  runtime::Process& process_;
  std::unique_ptr<devices::Parser> parser_;
  std::unique_ptr<devices::Dialogue> dialogue_;
  devices::ClockMap clock_;
  Watch watch_;
  LeverArm arm_;
  std::optional<Eigen::Quaterniond> q_WN_;  ///< of the north that the instrument means
  LineRecord record_;
  std::optional<link::RawReader> recording_;  ///< in place of the link, where a log is read
  std::optional<link::RawPiece> piece_;       ///< its next one
  Utime arrival_{};
  double told_{};  ///< when the instrument was told anew
  std::string said_;
  link::Link link_;  // last: its handlers use the others
};

void declare(runtime::Process& process, devices::Kind kind) {
  switch (kind) {
    case devices::Kind::kAhrs:
      return process.publishes<fathom_lcm::ahrs_t>(wire::kAhrs);
    case devices::Kind::kDvl:
      return process.publishes<fathom_lcm::dvl_t>(wire::kDvl);
    case devices::Kind::kUsbl:
      return process.publishes<fathom_lcm::usbl_t>(wire::kUsbl);
    case devices::Kind::kRanges:
      return process.publishes<fathom_lcm::ranges_t>(wire::kRanges);
    case devices::Kind::kDepth:
      return process.publishes<fathom_lcm::depth_t>(wire::kDepth);
    case devices::Kind::kLoads:
      return process.publishes<fathom_lcm::loads_t>(wire::kLoads);
    case devices::Kind::kThrusters:
      return;  // a driver of its own
  }
}

}  // namespace

int sensor_main(const char* name, devices::Kind kind, int argc, const char* const* argv) {
  const runtime::Program program{name, "Reads the bytes of an instrument and publishes what they measure."};
  return runtime::main(program, argc, argv, [kind](runtime::Process& process) {
    const Config config = process.config();
    declare(process, kind);
    const std::string protocol = config.text("protocol");
    if (kind == devices::Kind::kDepth && protocol == "ms5837") {
      PressureSensor sensor{process, config};
      return process.run();
    }
    SensorDriver driver{process, config, devices::protocol(protocol, config.where("protocol"), &kind)};
    process.run();
  });
}

}  // namespace fathom::driver
