#include "common/wire/vehicle.hpp"

#include <fathom_lcm/vehicle_condition_t.hpp>

#include "common/wire/plausible.hpp"

namespace fathom::wire {

std::optional<VehicleCondition> decode(const fathom_lcm::vehicle_condition_t& message) {
  if (!finite(message.heartbeat_age) || !finite(message.voltage) || !finite(message.voltage_floor)) return {};
  if (!finite(message.asked) || !finite(message.applied)) return {};
  if (!length(message.n_texts, message.texts.size()) || !length(message.n_lines, message.lines.size())) return {};
  VehicleCondition sample{.utime = message.utime,
                          .kind = message.kind,
                          .heartbeat_age = message.heartbeat_age,
                          .armed = message.armed,
                          .mode = message.mode,
                          .failsafe = message.failsafe != 0,
                          .voltage = message.voltage,
                          .voltage_floor = message.voltage_floor,
                          .asked = vector(message.asked),
                          .has_applied = message.has_applied != 0,
                          .applied = vector(message.applied)};
  for (const auto& part : message.texts) {
    if (!finite(part.age)) return {};
    sample.texts.push_back({.severity = part.severity, .text = part.text, .age = part.age});
  }
  for (const auto& part : message.lines) {
    sample.lines.push_back({.name = part.name, .ok = part.ok != 0, .grave = part.grave != 0, .text = part.text});
  }
  return sample;
}

fathom_lcm::vehicle_condition_t encode(const VehicleCondition& sample) {
  fathom_lcm::vehicle_condition_t message{};
  message.utime = sample.utime;
  message.kind = sample.kind;
  message.heartbeat_age = sample.heartbeat_age;
  message.armed = sample.armed;
  message.mode = sample.mode;
  message.failsafe = sample.failsafe;
  message.voltage = sample.voltage;
  message.voltage_floor = sample.voltage_floor;
  put(sample.asked, message.asked);
  message.has_applied = sample.has_applied;
  put(sample.applied, message.applied);
  message.n_texts = count(sample.texts);
  for (const VehicleText& part : sample.texts) {
    auto& to = message.texts.emplace_back();
    to.severity = part.severity;
    to.text = part.text;
    to.age = part.age;
  }
  message.n_lines = count(sample.lines);
  for (const ConditionLine& part : sample.lines) {
    auto& to = message.lines.emplace_back();
    to.name = part.name;
    to.ok = part.ok;
    to.grave = part.grave;
    to.text = part.text;
  }
  return message;
}

}  // namespace fathom::wire
