#include "common/driver/vehicle_check.hpp"

#include "common/devices/mavlink.hpp"

namespace fathom::driver {
namespace {

constexpr double kRecent = 3.0;  // s: three heartbeats, or a refusal that has not been said again

// Numbers of MAVLink's common definitions.
constexpr std::uint32_t kHeartbeat = 0, kCommandAck = 77, kStatusText = 253;
constexpr double kWarning = 4.0;  // severity; smaller is worse
constexpr int kAutopilotComponent = 1, kArduPilot = 3, kSubmarine = 12;
constexpr int kMotorTest = 209, kAccepted = 0, kInProgress = 5;

}  // namespace

void VehicleCheck::hear(const devices::Mavlink& packet, double now) {
  if (packet.component() != kAutopilotComponent) return;
  if (packet.id() == kHeartbeat) {
    const int type = static_cast<int>(packet.value(1)), autopilot = static_cast<int>(packet.value(2));
    std::string wrong;
    if (autopilot != kArduPilot || type != kSubmarine) {
      wrong = "the vehicle's firmware is not ArduSub (autopilot " + std::to_string(autopilot) + ", vehicle type " +
              std::to_string(type) + "); load ArduSub";
    } else if (packet.system() != system_) {
      wrong = "the vehicle that answers has the number " + std::to_string(packet.system()) +
              "; is it the right one? Then set 'system' to it";
    }
    if (wrong.empty()) {
      right_at_ = now;
    } else {
      wrong_at_ = now;
      wrong_ = wrong;
    }
  }
  if (packet.id() == kStatusText && packet.system() == system_ && packet.value(0) <= kWarning) {
    warned_at_ = now;
    warning_ = packet.text();
  }
  if (packet.id() == kCommandAck && packet.system() == system_ && static_cast<int>(packet.value(0)) == kMotorTest) {
    result_ = static_cast<int>(packet.value(1));
    refused_at_.reset();
    if (result_ != kAccepted && result_ != kInProgress) refused_at_ = now;
  }
}

std::string VehicleCheck::objection(double now) const {
  const auto recent = [&](const std::optional<double>& when) { return when && now - *when <= kRecent; };
  if (recent(wrong_at_) && !recent(right_at_)) return wrong_;
  if (recent(refused_at_)) {
    // What it wants depends on its version; it knows best.
    return "the vehicle refuses motor tests (result " + std::to_string(result_) + "); " +
           (recent(warned_at_)
                ? "it says '" + warning_ + "'"
                : "look at its safety switch, arm or disarm it, and leave it ten seconds after a failure");
  }
  return {};
}

}  // namespace fathom::driver
