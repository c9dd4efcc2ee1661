// USBL: the transceiver in the water pings, the responder on the vehicle answers; range and two bearings, each with
// white noise, bearings also with an offset drawn per run; now and then an outlier that the instrument trusts. Turned
// into a position in W, the responder's lever arm taken out with the attitude that AHRS tells. The stated sigma follows
// from the noise's settings. Not modelled: motion of the boat, bent rays, the vehicle's way while the sound travels.
#include <cmath>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class UsblSensor final : public Sensor {
 public:
  UsblSensor(const Config& config, const Surroundings& around)
      : p_BS_{around.vehicle->mounts.usbl->p_BS},
        p_WR_{around.site->transceiver.value_or(Eigen::Vector3d::Zero())},
        ahrs_{around.ahrs},
        raw_{around.raw},
        range_noise_{config.not_negative("range_noise", "m")},
        bearing_noise_{config.not_negative("bearing_noise", "rad")},
        outlier_{probability(config, "outlier")},
        outlier_size_{config.not_negative("outlier_size", "m")},
        farthest_{config.positive("farthest", "m")},
        stream_{around.seed, "usbl"} {
    const double offset = config.not_negative("bearing_offset", "rad");
    azimuth_offset_ = offset * stream_.normal();
    elevation_offset_ = offset * stream_.normal();
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const double range_error = range_noise_ * stream_.normal();
    const double azimuth_error = azimuth_offset_ + bearing_noise_ * stream_.normal();
    const double elevation_error = elevation_offset_ + bearing_noise_ * stream_.normal();
    const bool wild = stream_.chance(outlier_);
    const Eigen::Vector3d astray{stream_.uniform(-1.0, 1.0), stream_.uniform(-1.0, 1.0), stream_.uniform(-1.0, 1.0)};
    const Eigen::Vector3d to = moment.p_WB + moment.R_WB * p_BS_ - p_WR_;
    const double range = to.norm();
    if (range > farthest_ || (!raw_ && !ahrs_->newest.has_attitude)) return;
    const double azimuth = std::atan2(to.y(), to.x()) + azimuth_error;
    const double elevation = std::asin(range > 0.0 ? to.z() / range : 1.0) + elevation_error;
    const Eigen::Vector3d seen{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                               std::sin(elevation)};
    Usbl sample{.utime = moment.utime, .valid = true};
    sample.p_WB = p_WR_ + (range + range_error) * seen;
    if (!raw_) sample.p_WB -= ahrs_->q_WB(moment) * p_BS_;
    if (wild) sample.p_WB += outlier_size_ * astray;
    const double across = range * bearing_noise_;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double along = range_noise_ * seen[i];
      sample.sigma[i] = std::sqrt(along * along + across * across * (1.0 - seen[i] * seen[i]));
    }
    samples.emplace_back(sample);
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    return {{"azimuth_offset", azimuth_offset_}, {"elevation_offset", elevation_offset_}};
  }

 private:
  Eigen::Vector3d p_BS_, p_WR_;
  const AhrsTold* ahrs_;
  bool raw_;
  double range_noise_, bearing_noise_, outlier_, outlier_size_, farthest_;
  RandomStream stream_;
  double azimuth_offset_{}, elevation_offset_{};
};

}  // namespace

std::unique_ptr<Sensor> make_usbl(const Config& config, const Surroundings& around) {
  if (!around.vehicle->mounts.usbl) config.fail("rate", "the vehicle file has no sensors.usbl");
  auto sensor = std::make_unique<UsblSensor>(config, around);  // reads its section in any case
  if (!around.site->transceiver) return nullptr;
  return sensor;
}

}  // namespace fathom::simulation
