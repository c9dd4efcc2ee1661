// Pressure gauge: depth of its port below the surface, white noise, an offset drawn per run (air pressure), steps of
// its resolution. The driver takes the port's lever arm out with the attitude that AHRS tells. Not modelled: waves'
// pressure, density that changes with depth.
#include <cmath>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class DepthSensor final : public Sensor {
 public:
  DepthSensor(const Config& config, const Surroundings& around)
      : p_BP_{around.vehicle->mounts.depth->p_BS},
        ahrs_{around.ahrs},
        raw_{around.raw},
        noise_{config.not_negative("noise", "m")},
        resolution_{config.not_negative("resolution", "m")},
        stream_{around.seed, "depth"} {
    offset_ = config.not_negative("offset", "m") * stream_.normal();
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    double z = moment.p_WB.z() + (moment.R_WB * p_BP_).z() + offset_ + noise_ * stream_.normal();
    if (resolution_ > 0.0) z = resolution_ * std::round(z / resolution_);
    if (!raw_) z -= ahrs_->newest.has_attitude ? (ahrs_->q_WB(moment) * p_BP_).z() : p_BP_.z();
    samples.emplace_back(Depth{.utime = moment.utime, .z = z});
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override { return {{"offset", offset_}}; }

 private:
  Eigen::Vector3d p_BP_;
  const AhrsTold* ahrs_;
  bool raw_;
  double noise_, resolution_;
  RandomStream stream_;
  double offset_{};
};

}  // namespace

std::unique_ptr<Sensor> make_depth(const Config& config, const Surroundings& around) {
  if (!around.vehicle->mounts.depth) config.fail("rate", "the vehicle file has no sensors.depth");
  return std::make_unique<DepthSensor>(config, around);
}

}  // namespace fathom::simulation
