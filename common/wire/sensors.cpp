#include "common/wire/sensors.hpp"

#include <algorithm>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/loads_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/signal_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/usbl_t.hpp>

#include "common/wire/plausible.hpp"

namespace fathom::wire {

std::optional<Ahrs> decode(const fathom_lcm::ahrs_t& message) {
  if (!finite(message.w_WB_B) || !finite(message.f_B) || !unit(message.q_WB)) return {};
  return Ahrs{.utime = message.utime,
              .w_WB_B = vector(message.w_WB_B),
              .f_B = vector(message.f_B),
              .q_WB = quaternion(message.q_WB),
              .has_rates = message.has_rates != 0,
              .has_specific_force = message.has_specific_force != 0,
              .has_attitude = message.has_attitude != 0};
}

fathom_lcm::ahrs_t encode(const Ahrs& sample) {
  fathom_lcm::ahrs_t message{};
  message.utime = sample.utime;
  put(sample.w_WB_B, message.w_WB_B);
  put(sample.f_B, message.f_B);
  put(sample.q_WB, message.q_WB);
  message.has_rates = sample.has_rates;
  message.has_specific_force = sample.has_specific_force;
  message.has_attitude = sample.has_attitude;
  return message;
}

std::optional<Dvl> decode(const fathom_lcm::dvl_t& message) {
  if (!finite(message.v_WB_B) || !finite(message.altitude)) return {};
  return Dvl{.utime = message.utime,
             .v_WB_B = vector(message.v_WB_B),
             .altitude = message.altitude,
             .valid = message.valid != 0,
             .held = message.held != 0};
}

fathom_lcm::dvl_t encode(const Dvl& sample) {
  fathom_lcm::dvl_t message{};
  message.utime = sample.utime;
  put(sample.v_WB_B, message.v_WB_B);
  message.altitude = sample.altitude;
  message.valid = sample.valid;
  message.held = sample.held;
  return message;
}

std::optional<Usbl> decode(const fathom_lcm::usbl_t& message) {
  if (!finite(message.p_WB) || !finite(message.sigma)) return {};
  return Usbl{.utime = message.utime,
              .p_WB = vector(message.p_WB),
              .sigma = vector(message.sigma),
              .valid = message.valid != 0};
}

fathom_lcm::usbl_t encode(const Usbl& sample) {
  fathom_lcm::usbl_t message{};
  message.utime = sample.utime;
  put(sample.p_WB, message.p_WB);
  put(sample.sigma, message.sigma);
  message.valid = sample.valid;
  return message;
}

std::optional<Depth> decode(const fathom_lcm::depth_t& message) {
  if (!finite(message.z)) return {};
  return Depth{.utime = message.utime, .z = message.z};
}

fathom_lcm::depth_t encode(const Depth& sample) {
  fathom_lcm::depth_t message{};
  message.utime = sample.utime;
  message.z = sample.z;
  return message;
}

std::optional<Ranges> decode(const fathom_lcm::ranges_t& message) {
  if (!length(message.n_range, message.range.size()) || !length(message.n_range, message.valid.size())) return {};
  if (!finite(message.range)) return {};
  Ranges sample{.utime = message.utime, .range = message.range, .valid = {}};
  for (const auto flag : message.valid) sample.valid.push_back(flag != 0 ? 1 : 0);
  return sample;
}

fathom_lcm::ranges_t encode(const Ranges& sample) {
  fathom_lcm::ranges_t message{};
  message.utime = sample.utime;
  message.n_range = count(sample.range);
  message.range = sample.range;
  // lcm-gen writes as many flags as there are ranges, whatever the vector holds: a missing flag is "no echo".
  message.valid.resize(sample.range.size());
  for (std::size_t i = 0; i < std::min(sample.range.size(), sample.valid.size()); ++i) {
    message.valid[i] = sample.valid[i] != 0;
  }
  return message;
}

std::optional<Loads> decode(const fathom_lcm::loads_t& message) {
  if (!length(message.n_load, message.load.size()) || !finite(message.load)) return {};
  return Loads{.utime = message.utime, .load = message.load};
}

fathom_lcm::loads_t encode(const Loads& sample) {
  fathom_lcm::loads_t message{};
  message.utime = sample.utime;
  message.n_load = count(sample.load);
  message.load = sample.load;
  return message;
}

std::optional<Signal> decode(const fathom_lcm::signal_t& message) {
  if (!finite(message.value)) return {};
  return Signal{.utime = message.utime,
                .name = message.name,
                .quantity = message.quantity,
                .unit = message.unit,
                .value = message.value};
}

fathom_lcm::signal_t encode(const Signal& sample) {
  fathom_lcm::signal_t message{};
  message.utime = sample.utime;
  message.name = sample.name;
  message.quantity = sample.quantity;
  message.unit = sample.unit;
  message.value = sample.value;
  return message;
}

std::optional<PoseCapture> decode(const fathom_lcm::pose_capture_t& message) {
  if (!finite(message.p_WB) || !unit(message.q_WB)) return {};
  return PoseCapture{.utime = message.utime,
                     .p_WB = vector(message.p_WB),
                     .q_WB = quaternion(message.q_WB),
                     .valid = message.valid != 0,
                     .has_position = message.has_position != 0,
                     .has_attitude = message.has_attitude != 0};
}

fathom_lcm::pose_capture_t encode(const PoseCapture& sample) {
  fathom_lcm::pose_capture_t message{};
  message.utime = sample.utime;
  put(sample.p_WB, message.p_WB);
  put(sample.q_WB, message.q_WB);
  message.valid = sample.valid;
  message.has_position = sample.has_position;
  message.has_attitude = sample.has_attitude;
  return message;
}

std::optional<Battery> decode(const fathom_lcm::battery_t& message) {
  if (!finite(message.voltage)) return {};
  return Battery{.utime = message.utime, .voltage = message.voltage};
}

fathom_lcm::battery_t encode(const Battery& sample) {
  fathom_lcm::battery_t message{};
  message.utime = sample.utime;
  message.voltage = sample.voltage;
  return message;
}

std::optional<Thrusters> decode(const fathom_lcm::thrusters_t& message) {
  if (!length(message.n_pwm, message.pwm_us.size()) || !length(message.n_force, message.force.size())) return {};
  if (!finite(message.pwm_us) || !finite(message.force) || !finite(message.tau)) return {};
  return Thrusters{.utime = message.utime,
                   .pwm_us = message.pwm_us,
                   .force = message.force,
                   .tau = std::to_array(message.tau),
                   .has_tau = message.has_tau != 0};
}

fathom_lcm::thrusters_t encode(const Thrusters& sample) {
  fathom_lcm::thrusters_t message{};
  message.utime = sample.utime;
  message.n_pwm = count(sample.pwm_us);
  message.pwm_us = sample.pwm_us;
  message.n_force = count(sample.force);
  message.force = sample.force;
  std::copy(sample.tau.begin(), sample.tau.end(), message.tau);
  message.has_tau = sample.has_tau;
  return message;
}

}  // namespace fathom::wire
