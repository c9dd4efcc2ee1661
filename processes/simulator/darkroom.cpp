#include "processes/simulator/darkroom.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <thread>

#include "common/base/config.hpp"
#include "common/vision/jpeg.hpp"

namespace fathom::simulator {
namespace {

constexpr int kQuality = 90;
constexpr double kDeveloping = 8e-3;  // s: longer than it takes, so that a picture's age does not depend on the host

// The keys are read whether pictures are wanted or not: none shall count as unknown.
vision::RenderSettings look_of(const Config& config) {
  const Config sensors = config.section("sensors");
  if (!sensors.has("camera")) return {};
  const Config camera = sensors.section("camera");
  return camera.has("look") ? vision::RenderSettings::from(camera.section("look")) : vision::RenderSettings{};
}

double latency_of(const Config& config) {
  const Config sensors = config.section("sensors");
  return sensors.has("camera") ? sensors.section("camera").not_negative("latency", "s") : 0.0;
}

// Until the host's clock shows this, and no longer than `most` [s].
void wait_until(Utime due, double most) {
  using std::chrono::microseconds, std::chrono::system_clock;
  const system_clock::time_point now = system_clock::now(), at{microseconds{due}};
  if (at > now)
    std::this_thread::sleep_for(std::min<system_clock::duration>(
        at - now, std::chrono::duration_cast<system_clock::duration>(std::chrono::duration<double>{most})));
}

}  // namespace

Darkroom::Darkroom(const model::Vehicle& vehicle, const model::Site& site, const Config& config,
                   const simulation::Setup& setup)
    : origin_{setup.origin}, age_{latency_of(config) + kDeveloping} {
  const vision::RenderSettings look = look_of(config);
  if (!setup.pictures) return;
  const model::CameraMount& camera = vehicle.mounts.cameras.front();
  const auto& laser = vehicle.mounts.laser;
  renderer_.emplace(site, camera.lens, laser && laser->camera == camera.name ? laser : std::nullopt, look, setup.seed);
}

// What the line does not take is lost: no camera waits for who does not read.
void Darkroom::send(const simulation::Exposure& exposure) {
  const Camera picture = develop(exposure);
  (void)line_->wait(0.0);
  wait_until(utime_after(exposure.utime, age_), kDeveloping);
  (void)line_->send(std::string_view{reinterpret_cast<const char*>(picture.jpeg.data()), picture.jpeg.size()});
}

Camera Darkroom::develop(const simulation::Exposure& exposure) {
  const double t = seconds_between(origin_, exposure.utime);
  const cv::Mat& picture = renderer_->step(t, {.p_WC = exposure.p_WC, .R_WC = exposure.R_WC});
  return {.utime = exposure.utime,
          .camera = exposure.camera,
          .width = picture.cols,
          .height = picture.rows,
          .jpeg = vision::encode_jpeg(picture, kQuality)};
}

}  // namespace fathom::simulator
