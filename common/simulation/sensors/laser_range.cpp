// Laser dot in the picture of a camera: where the beam meets floor or wall, told by triangulation; the error of finding
// the dot, in pixels, becomes one of distance: sigma_z = z^2 sigma_px / (f b), along the line of sight.
// Not modelled: refraction at the housing, a dot that scatters.
#include <cmath>

#include "common/base/config.hpp"
#include "common/simulation/boundaries.hpp"
#include "common/simulation/camera_view.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class LaserRangeSensor final : public Sensor {
 public:
  LaserRangeSensor(const Config& config, const Surroundings& around)
      : laser_{*around.vehicle->mounts.laser},
        camera_{*around.vehicle->mounts.camera(laser_.camera)},
        site_{around.site},
        noise_{config.not_negative("dot_noise", "")},
        farthest_{config.positive("farthest", "m")},
        outlier_{probability(config, "outlier")},
        stream_{around.seed, "laser_range"} {
    scale_ = config.not_negative("scale_error", "") * stream_.normal();
    baseline_ = laser_.p_CE.head<2>().norm();
    if (baseline_ <= 0.0) config.fail("dot_noise", "the laser sits in the camera's axis: no triangulation");
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const double error = stream_.normal(), wild = stream_.uniform(-0.5, 0.5);
    const bool is_wild = stream_.chance(outlier_);
    const CameraView view{camera_, moment};
    const Eigen::Vector3d p_WE = view.p_WC + view.R_WC * laser_.p_CE;
    const double distance = distance_along(*site_, p_WE, view.R_WC * laser_.axis_C);
    const Eigen::Vector3d p_CL = laser_.p_CE + distance * laser_.axis_C;
    if (!(distance <= farthest_) || !view.sees(p_CL)) return;
    const double z = p_CL.z();
    const double relative = z * noise_ / (camera_.focal * baseline_);
    const double stretch = 1.0 + scale_ + relative * error + (is_wild ? wild : 0.0);
    samples.emplace_back(LaserRange{
        .utime = moment.utime, .camera = camera_.name, .p_CL = p_CL * stretch, .sigma_range = relative * p_CL.norm()});
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override { return {{"scale_error", scale_}}; }

 private:
  model::LaserMount laser_;
  model::CameraMount camera_;
  const model::Site* site_;
  double noise_, farthest_, outlier_;
  RandomStream stream_;
  double baseline_{}, scale_{};
};

}  // namespace

std::unique_ptr<Sensor> make_laser_range(const Config& config, const Surroundings& around) {
  if (!around.vehicle->mounts.laser) config.fail("rate", "the vehicle file has no sensors.laser");
  return std::make_unique<LaserRangeSensor>(config, around);
}

}  // namespace fathom::simulation
