// What a map says of thrusters and other actuators.
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/drafts/ardusub_mixer.hpp"
#include "common/tables/map_keys.hpp"
#include "common/tables/map_sections.hpp"

namespace fathom::tables::map_sections {

using namespace map_keys;  // NOLINT(google-build-using-namespace)

namespace {

StickColumns sticks_of(const Config& config) {
  constexpr std::size_t kSticks = 6;
  StickColumns sticks{.pulses = {components_of(config, "columns", kSticks), 1.0},
                      .frame = config.text("frame"),
                      .coupling = config.has("coupling") ? config.not_negative("coupling", "") : 1.0,
                      .reversed = {},
                      .neutral = config.positive("neutral", "us"),
                      .full = config.positive("full", "us")};
  need_count(config, "columns", sticks.pulses.columns, kSticks);
  if (config.has("reversed")) {
    for (const double number : config.quantities("reversed", "")) {
      if (number != std::round(number)) config.fail("reversed", "'reversed' lists numbers of motors, 1 the first");
      sticks.reversed.push_back(static_cast<int>(number));
    }
  }
  try {
    (void)drafts::ArdusubMixer{sticks.frame, sticks.coupling, sticks.reversed};
  } catch (const InputError& error) {
    config.fail("frame", error.what());
  }
  return sticks;
}

/// To the unit in which a vehicle file's actuators take their commands.
double command_factor(const Config& config, const std::string& unit) {
  for (const char* wanted : {"us", "rad/s", "rad", "N", "m^3", "kg", "m"}) {
    try {
      return unit_factor(unit, wanted);
    } catch (const InputError&) {  // of another kind
    }
  }
  config.fail("units", "'" + unit +
                           "' is no unit of a command: us (a pulse), rpm (a shaft), deg (a rudder), N, cc (volume of a "
                           "buoyancy engine), kg (ballast) or mm (a moving mass)");
}

InputColumns inputs_of(const Config& config) {
  InputColumns inputs{.group = {columns_of(config, "columns"), 1.0}, .units = config.texts("units")};
  if (inputs.units.size() != inputs.group.columns.size())
    config.fail("units", "'units' needs one unit for each of 'columns', [rpm, rpm, deg] for example");
  for (const std::string& unit : inputs.units) inputs.factors.push_back(command_factor(config, unit));
  return inputs;
}

}  // namespace

ThrusterColumns thrusters_of(const Config& config) {
  ThrusterColumns thrusters;
  if (config.has("inputs")) {
    if (config.has("pwm") || config.has("command"))
      config.fail("inputs", "state 'inputs' alone: pulses are columns of it with the unit us");
    thrusters.inputs = inputs_of(config.section("inputs"));
  }
  if (config.has("pwm")) thrusters.pwm = group_of(config.section("pwm"), "us");
  if (config.has("force")) thrusters.force = group_of(config.section("force"), "N");
  if (config.has("command")) {
    const Config command = config.section("command");
    if (thrusters.pwm) config.fail("command", "state 'pwm' or 'command', not both: a command becomes a pulse");
    thrusters.command = {
        {columns_of(command, "columns"), 1.0}, command.positive("neutral", "us"), command.positive("full", "us")};
  }
  if (config.has("sticks")) {
    const Config sticks = config.section("sticks");
    if (thrusters.pwm || thrusters.command || thrusters.inputs)
      config.fail("sticks", "state one of 'pwm', 'command', 'inputs' and 'sticks': each tells commands");
    thrusters.sticks = sticks_of(sticks);
  }
  if (config.has("speed")) {
    const Config speed = config.section("speed");
    constexpr const char* kUnit = "N/(rad/s)^2";
    if (thrusters.force) config.fail("speed", "state 'force' or 'speed', not both: a speed becomes a force");
    const double ahead = speed.positive("ahead", kUnit);
    thrusters.speed = {group_of(speed, "rad/s"), ahead, speed.has("astern") ? speed.positive("astern", kUnit) : ahead};
  }
  if (config.has("wrench")) {
    const Config wrench = config.section("wrench");
    const std::vector<Column> columns = components_of(wrench, "columns", 6);
    const auto split = columns.begin() + (columns.size() == 6 ? 3 : static_cast<std::ptrdiff_t>(columns.size()));
    const Eigen::Matrix3d frame = body_frame(wrench, "frame");
    thrusters.wrench_force = {{columns.begin(), split}, factor_to(wrench, "force_unit", "N"), frame};
    thrusters.wrench_moment = {{split, columns.end()}, factor_to(wrench, "moment_unit", "N m"), frame};
  }
  if (!thrusters.pwm && !thrusters.command && !thrusters.sticks && !thrusters.inputs && !thrusters.force &&
      !thrusters.speed && !thrusters.wrench_force) {
    config.fail("", "'thrusters' needs pwm, command, force, speed or wrench");
  }
  thrusters.invalid_where = invalid_of(config);
  return thrusters;
}

}  // namespace fathom::tables::map_sections
