#include "processes/camera_driver/recorded_pictures.hpp"

#include <poll.h>

#include <algorithm>
#include <fathom_lcm/camera_t.hpp>
#include <utility>
#include <vector>

#include "common/base/config.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/sensors.hpp"
#include "processes/camera_driver/message.hpp"

namespace fathom::camera_driver {

using Clock = std::chrono::steady_clock;

RecordedSettings RecordedSettings::from(const Config& config) {
  RecordedSettings s{.camera = config.text("camera"), .pictures = config.text("pictures")};
  if (config.has("rate")) s.rate = config.positive("rate", "Hz");
  if (config.has("quality")) s.quality = config.integer("quality");
  if (s.quality < 1 || s.quality > 100) config.fail("quality", "'quality' is 1 to 100");
  if (config.has("speed")) s.speed = config.positive("speed", "");
  if (config.has("repeat")) s.repeat = config.flag("repeat");
  return s;
}

RecordedPictures::RecordedPictures(runtime::Process& process, RecordedSettings settings)
    : process_{process}, settings_{std::move(settings)}, source_{pictures::open(settings_.pictures, settings_.rate)} {}

void RecordedPictures::wait(std::span<const int> descriptors, int milliseconds) {
  if (milliseconds == 0) return;
  if (count_ > 0) {
    const double left = due_ - std::chrono::duration<double>(Clock::now() - began_).count();
    if (left > 1e-3) {
      std::vector<pollfd> watched;
      for (const int each : descriptors) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
      poll(watched.data(), watched.size(), std::min(milliseconds, static_cast<int>(left * 1e3)));
      return;
    }
  }
  auto frame = source_->next();
  if (!frame && remark_ != source_->remark()) {  // once, where it is repeated
    remark_ = source_->remark();
    process_.log_warning(remark_);
  }
  if (!frame && settings_.repeat && count_ > 0) {
    source_ = pictures::open(settings_.pictures, settings_.rate);
    offset_ = due_;
    frame = source_->next();
  }
  if (!frame) return process_.stop();
  publish(*frame);
}

void RecordedPictures::publish(pictures::Frame& frame) {
  if (count_ + unreadable_ == 0) {
    began_ = Clock::now();
    first_ = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
                 .count();
  }
  // They keep the intervals at which they were taken.
  const double taken = offset_ + frame.time / settings_.speed;
  due_ = taken + 1.0 / (source_->rate() > 0.0 ? source_->rate() * settings_.speed : 30.0);
  if (!frame.problem.empty()) {
    ++unreadable_;
    if (complaint_.empty()) process_.log_warning(frame.problem + "; the picture is left out");
    complaint_ = frame.problem;
    return;
  }
  complaint_.clear();
  ++count_;
  process_.publish(wire::kCamera, wire::encode(as_message(std::move(frame), utime_after(first_, taken),
                                                          settings_.camera, settings_.quality)));
}

runtime::Process::Condition RecordedPictures::condition() const {
  return {.unhealthy = complaint_,
          .detail = "pictures " + std::to_string(count_) + ", unreadable " + std::to_string(unreadable_)};
}

}  // namespace fathom::camera_driver
