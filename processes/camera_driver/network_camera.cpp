#include "processes/camera_driver/network_camera.hpp"

#include <chrono>
#include <cmath>
#include <fathom_lcm/camera_t.hpp>
#include <utility>

#include "common/vision/jpeg.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::camera_driver {
namespace {

constexpr double kSilence = 2.0;  // s without a picture

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

NetworkCamera::NetworkCamera(runtime::Process& process, NetworkSettings settings)
    : process_{process},
      settings_{std::move(settings)},
      stamps_{settings_.rate},
      link_{settings_.endpoint,
            [this](std::span<const std::uint8_t> bytes, Utime arrival) { received(bytes, arrival); },
            [this](bool up, const std::string& why) { changed(up, why); }} {}

void NetworkCamera::wait(std::span<const int> descriptors, int milliseconds) {
  link_.wait(descriptors, milliseconds);
  const bool silent = link_.up() && now() - last_ > kSilence;
  if (silent != silent_) process_.tell_health();
  silent_ = silent;
}

void NetworkCamera::changed(bool up, const std::string& why) {
  stream_.restart();
  last_ = now();
  if (std::exchange(why_, why) == why) return;
  if (up) {
    process_.log_info(settings_.endpoint.text + ": connected");
  } else {
    process_.log_warning(why);
  }
}

void NetworkCamera::received(std::span<const std::uint8_t> bytes, Utime arrival) {
  if (!stream_.inside()) begun_ = arrival;
  stream_.feed(bytes, [&](std::vector<std::uint8_t> jpeg) {
    publish(std::move(jpeg));
    begun_ = arrival;
  });
}

void NetworkCamera::publish(std::vector<std::uint8_t> jpeg) {
  cv::Mat grey, bgr;
  const std::string problem = vision::decode_jpeg(jpeg, false, grey, bgr);
  if (!problem.empty()) {
    ++unreadable_;
    if (complaint_.empty()) process_.log_warning(problem + "; the picture is left out");
    complaint_ = problem;
    return;
  }
  complaint_.clear();
  last_ = now();
  const auto stamp = stamps_.step(begun_);
  if (const std::string news = stamps_.news(); !news.empty()) process_.log_warning(settings_.endpoint.text + news);
  if (!stamp) return;
  ++count_;
  Camera sample{.utime = utime_after(*stamp, -settings_.latency),
                .camera = settings_.camera,
                .width = grey.cols,
                .height = grey.rows};
  sample.jpeg = std::move(jpeg);
  process_.publish(wire::kCamera, wire::encode(sample));
}

runtime::Process::Condition NetworkCamera::condition() const {
  std::string unhealthy = complaint_;
  const double silent = now() - last_;
  if (!link_.up()) {
    unhealthy = why_;
  } else if (silent > kSilence) {
    unhealthy = settings_.endpoint.text + ": connected, but no picture for " + std::to_string(std::lround(silent)) +
                " s; does it send JPEG?";
  }
  return {.unhealthy = unhealthy,
          .detail = "pictures " + std::to_string(count_) + ", unreadable " + std::to_string(unreadable_) + ", torn " +
                    std::to_string(stream_.torn()) + stamps_.detail()};
}

}  // namespace fathom::camera_driver
