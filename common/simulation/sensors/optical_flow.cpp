// Optical flow of the scene below between two pictures, the camera's rotation taken out: with z_C the distance to floor
// or wall along the camera's axis, flow_C = -v_C / z_C [1/s], mean of both pictures. White noise by the features' error
// in pixels, along the axis as much more as the picture is narrow; too near or too far there are none. The rotation is
// taken out with the rates that AHRS tells, so their error remains. Not modelled: tilt of the floor in the picture,
// features that stick to the lens, the own shadow.
#include <cmath>
#include <optional>

#include "common/base/config.hpp"
#include "common/simulation/boundaries.hpp"
#include "common/simulation/camera_view.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

constexpr int kTracks = 80;  // features that agree at a good distance

class OpticalFlowSensor final : public Sensor {
 public:
  OpticalFlowSensor(const Config& config, const Surroundings& around)
      : camera_{around.vehicle->mounts.cameras.front()},
        site_{around.site},
        ahrs_{around.ahrs},
        period_{1.0 / config.positive("rate", "Hz")},
        noise_{config.not_negative("noise", "")},
        nearest_{config.not_negative("nearest", "m")},
        farthest_{config.positive("farthest", "m")},
        outlier_{probability(config, "outlier")},
        stream_{around.seed, "optical_flow"},
        approach_stream_{around.seed, "optical_flow_approach"} {
    // Growth moves a feature by its distance from the middle: over a picture full of them the mean of its square.
    const double w = camera_.width / camera_.focal, h = camera_.height / camera_.focal;
    narrow_ = std::sqrt(12.0 / (w * w + h * h));
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const double sigma = noise_ / (camera_.focal * period_);
    Eigen::Vector3d noise;
    for (double& each : noise.head<2>()) each = sigma * stream_.normal();
    noise.z() = narrow_ * sigma * approach_stream_.normal();
    if (stream_.chance(outlier_)) noise *= 20.0;
    const CameraView view{camera_, moment};
    const double distance = distance_along(*site_, view.p_WC, view.R_WC.col(2));
    std::optional<Picture> now;
    if (distance >= nearest_ && distance <= farthest_) {
      const Eigen::Vector3d w = moment.nu.tail<3>();
      const Eigen::Matrix3d R_CB = camera_.mount.R_BS.transpose();
      const Eigen::Vector3d v_C = R_CB * (moment.nu_seen.head<3>() + w.cross(camera_.mount.p_BS));
      now = Picture{moment.utime, -v_C / distance};
      // What is left of the rotation where rates are known with an error: flow of a turning camera, x' = -w x ray.
      if (ahrs_->newest.has_rates) {
        const Eigen::Vector3d wrong = R_CB * ahrs_->rate_error;
        now->flow += Eigen::Vector3d{wrong.y(), -wrong.x(), 0.0};
      }
    }
    if (now && before_ && seconds_between(before_->utime, now->utime) < 1.5 * period_) {
      const double interval = seconds_between(before_->utime, now->utime);
      samples.emplace_back(
          OpticalFlow{.utime = before_->utime + (now->utime - before_->utime) / 2,
                      .camera = camera_.name,
                      .interval = interval,
                      .flow_C = 0.5 * (before_->flow + now->flow) + noise,
                      .covariance = Eigen::Vector3d{sigma, sigma, narrow_ * sigma}.cwiseAbs2().asDiagonal(),
                      .n_tracks = kTracks});
    }
    before_ = now;
  }

 private:
  struct Picture {
    Utime utime{};
    Eigen::Vector3d flow;
  };

  model::CameraMount camera_;
  const model::Site* site_;
  const AhrsTold* ahrs_;
  double period_, noise_, nearest_, farthest_, outlier_;
  double narrow_{};  ///< how much less well growth is seen than motion
  RandomStream stream_, approach_stream_;
  std::optional<Picture> before_;
};

}  // namespace

std::unique_ptr<Sensor> make_optical_flow(const Config& config, const Surroundings& around) {
  if (around.vehicle->mounts.cameras.empty()) config.fail("rate", "the vehicle file has no sensors.cameras");
  return std::make_unique<OpticalFlowSensor>(config, around);
}

}  // namespace fathom::simulation
