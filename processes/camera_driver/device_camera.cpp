#include "processes/camera_driver/device_camera.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fathom_lcm/camera_t.hpp>
#include <utility>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/sensors.hpp"
#include "processes/camera_driver/message.hpp"

namespace fathom::camera_driver {
namespace {

constexpr double kSilence = 2.0;  // s without a picture
constexpr double kAnew = 10.0;    // s after which a silent camera is opened anew
constexpr double kPause = 1.0;    // s between two attempts
constexpr double kAhead = 5e-3;   // s: a stamp may be computed from the camera's own clock
constexpr double kSlice = 0.02;   // s: OpenCV waits for the camera alone, not for the bus

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

DeviceSettings DeviceSettings::from(const Config& config) {
  DeviceSettings s{.camera = config.text("camera"), .device = {.device = config.text("device")}};
  const auto pixels = [&](const char* key, int& to) {
    if (!config.has(key)) return;
    to = config.integer(key);
    if (to <= 0) config.fail(key, std::string{"'"} + key + "' must be positive");
  };
  pixels("width", s.device.width);
  pixels("height", s.device.height);
  if (config.has("rate")) s.device.rate = config.positive("rate", "Hz");
  if (config.has("format")) s.device.format = config.text("format");
  if (config.has("quality")) s.quality = config.integer("quality");
  if (s.quality < 1 || s.quality > 100) config.fail("quality", "'quality' is 1 to 100");
  if (config.has("stamp")) {
    const std::string stamp = config.text("stamp");
    if (stamp != "kernel" && stamp != "arrival") config.fail("stamp", "'stamp' is kernel or arrival");
    s.kernel_stamps = stamp == "kernel";
  }
  s.device.newest_only = !s.kernel_stamps;
  // A stamp at the beginning of the exposure is earlier than its middle.
  s.latency = s.kernel_stamps ? config.quantity("latency", "s") : config.not_negative("latency", "s");
  return s;
}

DeviceCamera::DeviceCamera(runtime::Process& process, DeviceSettings settings)
    : process_{process},
      settings_{std::move(settings)},
      camera_{pictures::open_camera(settings_.device)},
      stamps_{settings_.kernel_stamps || !(settings_.device.rate > 0.0) ? std::nullopt
                                                                        : std::optional{settings_.device.rate}},
      last_{now()} {
  process_.log_info(settings_.device.device + ": " + camera_->description());
}

void DeviceCamera::wait(std::span<const int> descriptors, int milliseconds) {
  if (milliseconds == 0) return;
  if (!camera_) return try_again(descriptors, milliseconds);
  try {
    if (camera_->wait(std::min(kSlice, 1e-3 * milliseconds))) {
      publish(camera_->read());
      last_ = now();
    }
  } catch (const InputError& error) {
    if (count_ == 0) throw;  // it never gave one: somebody is starting this, and reads what is wrong
    return lost(error.what());
  }
  const double silence = now() - last_;
  if (silence > kAnew)
    return lost(settings_.device.device + ": no picture for " + std::to_string(std::lround(silence)) + " s");
  if (const bool silent = silence > kSilence; std::exchange(silent_, silent) != silent) {
    if (silent && count_ == 0) process_.log_warning(settings_.device.device + ": opened, and gives no picture");
    process_.tell_health();
  }
}

void DeviceCamera::publish(pictures::Frame frame) {
  age_ = frame.age.value_or(NAN);
  if (!frame.problem.empty()) return leave_out(frame.problem);
  if (settings_.kernel_stamps && !(age_ > -kAhead)) {
    const std::string fault = frame.age ? "is " + std::to_string(std::lround(-1e3 * age_)) + " ms ahead of its arrival"
                                        : "fits no clock of this host";
    const std::string why = settings_.device.device + ": the kernel's stamp of a picture " + fault;
    if (count_ > 0) return leave_out(why);
    throw InputError(why + "; state 'stamp: arrival', and as 'latency' the time from exposure to arrival");
  }
  if (std::exchange(lost_, false)) process_.log_info(settings_.device.device + ": the camera is back");
  complaint_.clear();
  const auto stamp = stamps_.step(frame.arrival);
  if (const std::string news = stamps_.news(); !news.empty()) process_.log_warning(settings_.device.device + news);
  if (!stamp) return;
  ++count_;
  const double since = settings_.latency + (settings_.kernel_stamps ? *frame.age : 0.0);
  const Utime utime = utime_after(*stamp, -since);
  process_.publish(wire::kCamera,
                   wire::encode(as_message(std::move(frame), utime, settings_.camera, settings_.quality)));
}

void DeviceCamera::leave_out(const std::string& why) {
  ++unreadable_;
  if (complaint_.empty()) process_.log_warning(why + "; the picture is left out");
  complaint_ = why;
}

void DeviceCamera::lost(const std::string& why) {
  complaint_ = why + "; tried again every second";
  if (!lost_) process_.log_warning(complaint_);
  lost_ = true;
  process_.tell_health();
  camera_.reset();
  last_try_ = now();
}

// A camera that was unplugged may come back.
void DeviceCamera::try_again(std::span<const int> descriptors, int milliseconds) {
  std::vector<pollfd> watched;
  for (const int each : descriptors) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  poll(watched.data(), watched.size(), milliseconds);
  if (now() - last_try_ < kPause) return;
  last_try_ = now();
  try {
    camera_ = pictures::open_camera(settings_.device);
    last_ = now();
    silent_ = false;
  } catch (const InputError& error) {
    complaint_ = error.what();
  }
}

runtime::Process::Condition DeviceCamera::condition() const {
  std::string unhealthy = complaint_;
  if (unhealthy.empty() && silent_) {
    unhealthy = settings_.device.device + ": no picture for " + std::to_string(std::lround(now() - last_)) + " s";
  }
  std::string detail = "pictures " + std::to_string(count_) + ", unreadable " + std::to_string(unreadable_);
  if (std::isfinite(age_) && count_ > 0) {
    detail += ", from the kernel's stamp to arrival " + std::to_string(std::lround(1e3 * age_)) + " ms";
  }
  return {.unhealthy = unhealthy, .detail = detail + stamps_.detail()};
}

}  // namespace fathom::camera_driver
