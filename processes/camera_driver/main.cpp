// camera_driver: pictures of a camera (of this host or on the network), a video or a folder as JPEG on CAMERA.
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <fathom_lcm/camera_t.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/pictures/source.hpp"
#include "common/runtime/process.hpp"
#include "common/vision/jpeg.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/sensors.hpp"
#include "processes/camera_driver/network_camera.hpp"

using namespace fathom;

namespace {

using Clock = std::chrono::steady_clock;

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Where pictures come from, as the section says it.
struct Settings {
  std::string camera, source;
  bool device{false};
  double rate{0.0}, speed{1.0}, latency{0.0};
  int quality{90}, width{0}, height{0};
  bool repeat{false};

  static Settings from(const Config& config) {
    Settings s{.camera = config.text("camera")};
    s.device = config.has("device");
    if (s.device == config.has("pictures")) {
      config.fail("device", "state either 'device' (a camera) or 'pictures' (a folder or a video)");
    }
    s.source = config.text(s.device ? "device" : "pictures");
    if (config.has("rate")) s.rate = config.positive("rate", "Hz");
    if (config.has("quality")) s.quality = config.integer("quality");
    if (s.quality < 1 || s.quality > 100) config.fail("quality", "'quality' is 1 to 100");
    if (s.device) {
      if (config.has("width")) s.width = config.integer("width");
      if (config.has("height")) s.height = config.integer("height");
      s.latency = config.not_negative("latency", "s");
    } else {
      if (config.has("speed")) s.speed = config.positive("speed", "");
      if (config.has("repeat")) s.repeat = config.flag("repeat");
    }
    return s;
  }
  [[nodiscard]] std::unique_ptr<pictures::Source> open() const {
    return device ? pictures::open_camera(source, width, height, rate) : pictures::open(source, rate);
  }
};

class CameraDriver {
 public:
  CameraDriver(runtime::Process& process, const Settings& settings) : process_{process}, settings_{settings} {
    source_ = settings.open();
  }

  void wait(std::span<const int> descriptors, int milliseconds) {
    if (milliseconds == 0) return;
    if (!source_) return try_again(descriptors, milliseconds);
    if (!settings_.device && count_ > 0) {
      const double left = due_ - seconds(Clock::now() - began_);
      if (left > 1e-3) return poll_for(descriptors, std::min(milliseconds, static_cast<int>(left * 1e3)));
    }
    auto frame = source_->next();
    if (!frame && settings_.repeat && count_ > 0) {
      source_ = settings_.open();
      offset_ = due_;
      frame = source_->next();
    }
    if (!frame) return ended();
    publish(*frame);
  }

  [[nodiscard]] runtime::Process::Condition condition() const {
    return {.unhealthy = complaint_,
            .detail = "pictures " + std::to_string(count_) + ", unreadable " + std::to_string(unreadable_)};
  }

 private:
  static void poll_for(std::span<const int> descriptors, int milliseconds) {
    std::vector<pollfd> watched;
    for (const int each : descriptors) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
    poll(watched.data(), watched.size(), milliseconds);
  }

  void publish(pictures::Frame& frame) {
    if (count_ + unreadable_ == 0) began_ = Clock::now();
    // Recorded pictures keep the intervals at which they were taken.
    const double taken = offset_ + frame.time / settings_.speed;
    if (count_ + unreadable_ == 0) first_ = wall_clock();
    due_ = taken + 1.0 / (source_->rate() > 0.0 ? source_->rate() * settings_.speed : 30.0);
    if (!frame.problem.empty()) {
      ++unreadable_;
      if (complaint_.empty()) process_.log_warning(frame.problem + "; the picture is left out");
      complaint_ = frame.problem;
      return;
    }
    complaint_.clear();
    ++count_;
    Camera sample{
        .utime = settings_.device ? utime_after(wall_clock(), -settings_.latency) : utime_after(first_, taken),
        .camera = settings_.camera,
        .width = frame.picture.cols,
        .height = frame.picture.rows};
    sample.jpeg = frame.jpeg.empty() ? vision::encode_jpeg(frame.picture, settings_.quality, frame.halved_colour)
                                     : std::move(frame.jpeg);
    process_.publish(wire::kCamera, wire::encode(sample));
  }

  void ended() {
    if (!settings_.device) return process_.stop();
    complaint_ = settings_.source + ": the camera gives no pictures any more; tried again every second";
    process_.log_warning(complaint_);
    process_.tell_health();
    source_.reset();
    last_try_ = Clock::now();
  }

  // A camera that was unplugged may come back.
  void try_again(std::span<const int> descriptors, int milliseconds) {
    poll_for(descriptors, milliseconds);
    if (seconds(Clock::now() - last_try_) < 1.0) return;
    last_try_ = Clock::now();
    try {
      source_ = settings_.open();
      process_.log_info("the camera is back");
      complaint_.clear();
    } catch (const InputError& error) {
      complaint_ = error.what();
    }
  }

  runtime::Process& process_;
  Settings settings_;
  std::unique_ptr<pictures::Source> source_;
  std::string complaint_;
  std::int64_t count_{}, unreadable_{};
  Clock::time_point began_{}, last_try_{};
  Utime first_{};
  double due_{}, offset_{};  ///< s since the first picture
};

}  // namespace

int main(int argc, char** argv) {
  return runtime::main("camera_driver", argc, argv, [](runtime::Process& process) {
    process.publishes<fathom_lcm::camera_t>(wire::kCamera);
    const Config config = process.config();
    if (config.has("device") && config.text("device").starts_with("tcp:")) {
      camera_driver::NetworkSettings settings{
          .camera = config.text("camera"),
          .endpoint = link::Endpoint::parse(config.text("device"), config.where("device")),
          .latency = config.not_negative("latency", "s")};
      std::unique_ptr<camera_driver::NetworkCamera> camera;  // not before it runs: --interface connects nowhere
      process.waits_with([&](std::span<const int> descriptors, int milliseconds) {
        if (!camera) camera = std::make_unique<camera_driver::NetworkCamera>(process, settings);
        camera->wait(descriptors, milliseconds);
      });
      process.on_health([&] { return camera ? camera->condition() : runtime::Process::Condition{}; });
      return process.run();
    }
    const Settings settings = Settings::from(config);
    std::unique_ptr<CameraDriver> driver;
    process.waits_with([&](std::span<const int> descriptors, int milliseconds) {
      if (!driver) driver = std::make_unique<CameraDriver>(process, settings);
      driver->wait(descriptors, milliseconds);
    });
    process.on_health([&] { return driver ? driver->condition() : runtime::Process::Condition{}; });
    process.run();
  });
}
