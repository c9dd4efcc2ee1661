#include "common/driver/vehicle_check.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/devices/ardusub_modes.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/thruster_text.hpp"

namespace fathom::driver {
namespace {

// Numbers of MAVLink's common definitions.
constexpr std::uint32_t kHeartbeat = 0, kCommandAck = 77, kStatusText = 253;
constexpr int kAutopilotComponent = 1, kArduPilot = 3, kSubmarine = 12;
constexpr int kArmed = 0x80;  // of the base mode
constexpr int kCritical = 5;  // state; ArduSub: a failsafe is active
constexpr int kMotorTest = 209, kAccepted = 0, kInProgress = 5;

std::string text_of(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : " or ") + name;
  return all;
}

Eigen::VectorXd forces(const model::Allocated& allocated) {
  return Eigen::Map<const Eigen::VectorXd>(allocated.force.data(), static_cast<Eigen::Index>(allocated.force.size()));
}

}  // namespace

VehicleCheck::VehicleCheck(const Expected& expected, const Limits& limits)
    : expected_{expected},
      limits_{limits},
      following_{Following::Limits{.least = limits.least_asked * expected.largest_thrust}} {}

void VehicleCheck::restart(double now) {
  begun_ = now;
  beat_at_.reset();
  right_at_.reset();
  wrong_at_.reset();
  refused_at_.reset();
  armed_ = -1;
  mode_.clear();
  failsafe_ = false;
  tells_state_ = false;
  following_.restart();
}

void VehicleCheck::remember(VehicleText words, double now) {
  if (words.severity > limits_.told_severity || words.text.empty()) return;
  constexpr std::size_t kMost = 10;
  std::erase_if(words_,
                [&](const Words& each) { return now - each.at > limits_.words || each.said.text == words.text; });
  if (words_.size() >= kMost) words_.erase(words_.begin());
  words_.push_back({.said = std::move(words), .at = now});
}

void VehicleCheck::hear(const devices::Mavlink& packet, double now) {
  if (packet.component() != kAutopilotComponent) return;
  if (packet.id() == kHeartbeat) {
    const int type = static_cast<int>(packet.value(1)), autopilot = static_cast<int>(packet.value(2));
    std::string wrong;
    if (autopilot != kArduPilot || type != kSubmarine) {
      wrong = "the vehicle's firmware is not ArduSub (autopilot " + std::to_string(autopilot) + ", vehicle type " +
              std::to_string(type) + "); load ArduSub";
    } else if (packet.system() != expected_.system) {
      wrong = "the vehicle that answers has the number " + std::to_string(packet.system()) +
              "; is it the right one? Then set 'system' to it";
    }
    if (!wrong.empty()) {
      wrong_at_ = now;
      wrong_ = wrong;
      return;
    }
    right_at_ = beat_at_ = now;
    armed_ = (static_cast<int>(packet.value(3)) & kArmed) != 0 ? 1 : 0;
    mode_ = devices::ardusub_mode_name(static_cast<std::uint32_t>(packet.value(0)));
    failsafe_ = static_cast<int>(packet.value(4)) >= kCritical;
    // What spoke against arming it does no longer when it is armed.
    if (armed_ == 1) std::erase_if(words_, [](const Words& each) { return each.said.text.starts_with("PreArm"); });
  }
  if (packet.system() != expected_.system) return;
  if (packet.id() == kStatusText) {
    remember({.severity = static_cast<int>(packet.value(0)), .text = packet.text(), .age = 0.0}, now);
  }
  if (packet.id() == kCommandAck && static_cast<int>(packet.value(0)) == kMotorTest) {
    result_ = static_cast<int>(packet.value(1));
    refused_at_.reset();
    if (result_ != kAccepted && result_ != kInProgress) refused_at_ = now;
  }
}

void VehicleCheck::hear(const devices::ThrusterText& sentence, double now) {
  if (sentence.words()) remember(*sentence.words(), now);
  if (const auto& state = sentence.state()) {
    tells_state_ = true;
    armed_ = state->armed ? 1 : 0;
    mode_ = state->mode;
    failsafe_ = state->failsafe;
    beat_at_ = now;
  }
  if (!tells_state_) beat_at_ = now;  // an older rig: whatever it says is its sign of life
}

void VehicleCheck::hear_voltage(double voltage, double now) {
  voltage_ = voltage;
  voltage_at_ = now;
  if (!(voltage < expected_.voltage_floor)) low_since_.reset();
  if (voltage < expected_.voltage_floor && !low_since_) low_since_ = now;
}

void VehicleCheck::asked(const model::Allocated& allocated, double now) {
  asked_ = allocated.tau;
  following_.asked(forces(allocated), now);
}

void VehicleCheck::applied(const model::Allocated& allocated, double now) {
  applied_ = allocated.tau;
  following_.applied(forces(allocated), now);
}

std::string VehicleCheck::another_vehicle(double now) const {
  return within(wrong_at_, now, limits_.heartbeat) && !within(right_at_, now, limits_.heartbeat) ? wrong_ : "";
}

std::string VehicleCheck::heartbeat_trouble(double now) const {
  if (within(beat_at_, now, limits_.heartbeat)) return {};
  const bool early = !beat_at_ && now - begun_ <= limits_.heartbeat;
  if (early) return "no heartbeat of the vehicle yet";
  return "no heartbeat of the vehicle: none for " + text_of("%.0f s", now - beat_at_.value_or(begun_)) +
         "; is its autopilot on, and its number the one in 'system'?";
}

VehicleCondition VehicleCheck::condition(Utime utime, double now) const {
  VehicleCondition all{.utime = utime};
  all.kind = expected_.kind == Kind::kArdusub ? "ArduSub" : expected_.kind == Kind::kRig ? "rig" : "dry run";
  all.asked = asked_;
  if (expected_.kind == Kind::kDryRun) {
    all.lines.push_back({.name = "vehicle", .text = "dry run: nothing is sent to any thruster"});
    return all;
  }
  all.heartbeat_age = beat_at_ ? now - *beat_at_ : -1.0;
  all.armed = armed_;
  all.mode = mode_;
  all.failsafe = failsafe_;
  all.voltage = within(voltage_at_, now, limits_.stale_voltage) ? voltage_ : 0.0;
  all.voltage_floor = expected_.voltage_floor;
  all.has_applied = following_.reports(now);
  if (all.has_applied) all.applied = applied_;
  for (const Words& each : words_) {
    if (now - each.at > limits_.words) continue;
    all.texts.push_back({.severity = each.said.severity, .text = each.said.text, .age = now - each.at});
  }
  say(all, now);
  return all;
}

// Grave ones first, then causes before what follows from them. What is not known counts as not well, unless the
// protocol never tells it.
void VehicleCheck::say(VehicleCondition& all, double now) const {
  const auto line = [&](const char* name, const std::string& trouble, const std::string& well, bool grave = false) {
    all.lines.push_back(
        {.name = name, .ok = trouble.empty(), .grave = grave, .text = trouble.empty() ? well : trouble});
  };
  const bool ardusub = expected_.kind == Kind::kArdusub;
  const bool alive = within(beat_at_, now, limits_.heartbeat);
  const bool told = alive && armed_ >= 0;
  const char* silent = "not known: no heartbeat";
  const char* older = "not told: a rig of before $FTSTA";
  if (ardusub) {
    line("vehicle", another_vehicle(now), "ArduSub, number " + std::to_string(expected_.system));
  }
  std::string failsafe, words;
  if (alive && failsafe_) failsafe = "the vehicle's own failsafe is active";
  for (const VehicleText& each : all.texts) {
    if (each.severity <= limits_.grave_severity) words = "the vehicle says '" + each.text + "'";
  }
  if (!failsafe.empty() && !words.empty()) failsafe += ": " + words;
  line("failsafe", failsafe.empty() ? words : failsafe, alive ? "none" : silent, true);
  std::string low;
  if (low_since_ && now - *low_since_ >= limits_.low_voltage && all.voltage > 0.0) {
    low = text_of("the battery is low: %.1f V", all.voltage) + text_of(", the floor is %.1f V", all.voltage_floor) +
          "; change or charge it";
  }
  std::string volts = all.voltage > 0.0 ? text_of("%.1f V", all.voltage) : "not told";
  volts += all.voltage_floor > 0.0 ? text_of(", floor %.1f V", all.voltage_floor) : ", no floor stated";
  line("voltage", low, volts, true);
  line("heartbeat", heartbeat_trouble(now), alive ? text_of("%.1f s ago", all.heartbeat_age) : "");
  const bool unknown = ardusub ? !told : !alive;
  std::string disarmed = unknown ? silent : "";
  if (told && armed_ == 0)
    disarmed = ardusub ? "the vehicle is disarmed: arm it (QGroundControl), then fathom arm"
                       : "the rig is disarmed: arm it, then fathom arm";
  line("armed", disarmed, told ? "armed" : older);
  std::string mode = unknown ? silent : "";
  const bool listed = expected_.modes.empty() ||
                      std::find(expected_.modes.begin(), expected_.modes.end(), mode_) != expected_.modes.end();
  if (told && !listed) {
    mode = "the vehicle is in " + (mode_.empty() ? "no mode" : mode_) + "; it obeys in " + joined(expected_.modes) +
           ": change its mode";
  }
  line("mode", mode, told ? (mode_.empty() ? "not told" : mode_) : older);
  if (ardusub && !expected_.must_report) {
    std::string refuses;
    if (within(refused_at_, now, limits_.refusal)) {
      const auto newest =
          std::max_element(words_.begin(), words_.end(), [](const Words& a, const Words& b) { return a.at < b.at; });
      const bool says = newest != words_.end() && now - newest->at <= limits_.refusal;
      refuses = "the vehicle refuses motor tests (result " + std::to_string(result_) + "); " +
                (says ? "it says '" + newest->said.text + "'"
                      : "look at its safety switch, arm or disarm it, and leave it ten seconds after a failure");
    }
    line("motor tests", refuses, "not refused");
  }
  std::string thrust = following_.trouble(now);
  if (thrust.empty() && expected_.must_report && alive && !all.has_applied)
    thrust = "the vehicle does not report its outputs: let it send SERVO_OUTPUT_RAW (SRn_RC_CHAN)";
  line("thrust", thrust, all.has_applied ? "as asked" : "not reported; what was sent is told");
}

std::string first_trouble(const VehicleCondition& condition) {
  for (const ConditionLine& line : condition.lines) {
    if (!line.ok) return line.text;
  }
  return {};
}

}  // namespace fathom::driver
