#include "common/excitation/segments.hpp"

#include <array>
#include <utility>

#include "common/base/motions.hpp"

namespace fathom::excitation {
namespace {

constexpr double kDuration = 20.0;  // s

Segment named(const std::string& name) { return {.name = name, .duration = kDuration}; }

}  // namespace

std::vector<Segment> segments(const model::Vehicle& vehicle, const Vector6d& largest) {
  std::vector<Segment> all;
  std::vector<Eigen::Index> axes;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (vehicle.dof[static_cast<std::size_t>(axis)] && largest[axis] > 0.0) axes.push_back(axis);
  }
  Segment together = named("full steps on all axes");
  for (const Eigen::Index axis : axes) {
    const std::string motion = kMotionNames[static_cast<std::size_t>(axis)];
    Segment full = named("full steps in " + motion), small = named("small steps in " + motion),
            slow = named("a slow sine in " + motion), quick = named("a quick sine in " + motion);
    full.step[axis] = 0.95;
    full.switch_at[axis] = 2.5;
    small.step[axis] = 0.2;
    small.switch_at[axis] = 2.5;
    slow.amplitude(axis, 0) = 0.8;
    slow.frequency(axis, 0) = 0.1;
    quick.amplitude(axis, 0) = 0.8;
    quick.frequency(axis, 0) = 0.5;
    together.step[axis] = 0.8;
    together.switch_at[axis] = 1.5 + 0.4 * static_cast<double>(axis);
    for (const auto& each : {full, small, slow, quick}) all.push_back(each);
    if (axis != 5 && axis < 3 && vehicle.dof[5] && largest[5] > 0.0) {
      Segment turning = named("full steps in " + motion + " while turning to and fro");
      turning.step[axis] = 0.9;
      turning.switch_at[axis] = 2.0;
      turning.amplitude(5, 0) = 0.8;
      turning.frequency(5, 0) = 0.15;
      all.push_back(turning);
    }
  }
  if (axes.size() > 1) all.push_back(together);
  return all;
}

std::optional<Segment> segment_named(const std::string& name, const model::Vehicle& vehicle, const Vector6d& largest) {
  for (Segment& one : segments(vehicle, largest)) {
    if (one.name == name) return std::move(one);
  }
  return std::nullopt;
}

std::optional<model::Manoeuvre> preset_named(const std::string& name) {
  if (name != "line" && name != "zigzag" && name != "circle") return {};
  model::Manoeuvre preset = model::manoeuvre_preset(name);
  preset.rest = 1.0;
  preset.straight = 3.0;
  preset.thrust = 0.6;      // share of the largest: what holds the other axes needs the rest
  preset.difference = 0.4;  // share of the largest
  preset.duration = name == "line" ? 15.0 : 40.0;
  return preset;
}

std::optional<Segment> segment_of(const model::Manoeuvre& preset, const std::string& name,
                                  const model::Vehicle& vehicle, const Vector6d& largest) {
  constexpr Eigen::Index kAhead = 0, kYaw = 5;
  const bool turns = preset.kind != model::ManoeuvreKind::kLine;
  const auto can = [&](Eigen::Index axis) {
    return vehicle.dof[static_cast<std::size_t>(axis)] && largest[axis] > 0.0;
  };
  if (!can(kAhead) || (turns && !can(kYaw))) return {};
  Segment segment{.name = name, .duration = preset.duration};
  segment.step[kAhead] = preset.thrust;
  if (turns) segment.step[kYaw] = preset.difference;
  return segment;
}

}  // namespace fathom::excitation
