#include "common/driver/pressure_sensor.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <thread>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/link/i2c.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::driver {
namespace {

constexpr double kFirstPause = 0.25, kLongestPause = 5.0;  // s between attempts to reach a lost sensor

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

std::string bus_path(const Config& config) {
  const std::string text = config.text("link");
  if (!text.starts_with("i2c:///dev/"))
    config.fail("link", "'link' of an ms5837 is i2c:///dev/i2c-N, not '" + text + "'");
  return text.substr(6);
}

devices::ms5837::Model model_of(const Config& config) {
  const auto model = devices::ms5837::model(config.text("sensor"));
  if (!model) config.fail("sensor", "'sensor' is 30BA (Bar30) or 02BA (Bar02)");
  return *model;
}

}  // namespace

PressureSensor::PressureSensor(runtime::Process& process, const Config& config)
    : process_{process},
      path_{bus_path(config)},
      model_{model_of(config)},
      period_{config.quantity("period", "s")},
      latency_{config.quantity("latency", "s")},
      density_{config.quantity("water_density", "kg/m^3")},
      gravity_{config.quantity("gravity", "m/s^2")},
      air_pressure_{config.quantity("air_pressure", "Pa")},
      arm_{config.vector3("position", "m")},
      watch_{period_, "ms5837"},
      pause_{kFirstPause} {
  constexpr double kQuickest = 0.05;  // s: two conversions take 41 ms
  if (period_ < kQuickest) config.fail("period", "an ms5837 needs 0.05 s for a reading");
  if (arm_.needed()) {
    process_.on_latest<fathom_lcm::ahrs_t>(wire::kAhrs, wire::kDecode,
                                           [this](const Ahrs& sample) { arm_.hear(sample); });
  }
  process_.waits_with([this](std::span<const int> descriptors, int limit_ms) { wait(descriptors, limit_ms); });
  process_.on_health([this] {
    return runtime::Process::Condition{.unhealthy = watch_.unhealthy(steady_seconds(), "", ""),
                                       .detail = "readings " + std::to_string(readings_) + ", lost " +
                                                 std::to_string(lost_) + ", gaps " + std::to_string(watch_.gaps())};
  });
}

void PressureSensor::wait(std::span<const int> descriptors, int milliseconds) {
  const double left = std::max(0.0, next_ - steady_seconds());
  std::vector<pollfd> watched;
  for (const int each : descriptors) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  poll(watched.data(), watched.size(), std::min(milliseconds, static_cast<int>(1e3 * left)));
  if (steady_seconds() >= next_) measure();
  const std::string unhealthy = watch_.unhealthy(steady_seconds(), "", "");
  if (unhealthy == said_) return;
  said_ = unhealthy;
  unhealthy.empty() ? process_.log_info("well: measurements come") : process_.log_warning(unhealthy);
  process_.tell_health();
}

void PressureSensor::lose(const std::string& why) {
  ++lost_;
  sensor_.reset();
  bus_.reset();
  watch_.link(false, why, steady_seconds());
  next_ = steady_seconds() + pause_;
  pause_ = std::min(2.0 * pause_, kLongestPause);
}

void PressureSensor::measure() {
  try {
    if (!sensor_) {
      bus_ = std::make_unique<link::LinuxI2c>(path_);
      sensor_.emplace(*bus_, model_, sleep);
      watch_.link(true, "", steady_seconds());
      pause_ = kFirstPause;
      next_ = steady_seconds();
    }
    next_ = std::max(next_ + period_, steady_seconds());
    const Utime begin = wall_clock();
    const auto reading = sensor_->measure();
    if (!reading) {
      ++lost_;
      return;
    }
    ++readings_;
    Depth sample{.utime = utime_after(begin, -latency_),
                 .z = (reading->pressure - air_pressure_) / (density_ * gravity_)};
    arm_.remove(sample);
    watch_.sample(sample.utime, steady_seconds());
    process_.publish(wire::kDepth, wire::encode(sample));
  } catch (const InputError& error) {
    lose(error.what());
  }
}

}  // namespace fathom::driver
