// Acoustic ranges to the site's transponders, all of one ping: white noise, one scale error per run (speed of sound),
// lost answers, now and then an echo by a longer way. From the transducer, not from Bo: the estimator knows where it
// sits. The hull may hide what lies ahead of it: then answers are lost more often. Not modelled: rays that bend, the
// vehicle's way while the sound travels.
#include <cmath>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class RangesSensor final : public Sensor {
 public:
  RangesSensor(const Config& config, const Surroundings& around)
      : p_BS_{around.vehicle->mounts.ranges->p_BS},
        site_{around.site},
        noise_{config.not_negative("noise", "m")},
        loss_{probability(config, "loss")},
        outlier_{probability(config, "outlier")},
        outlier_size_{config.not_negative("outlier_size", "m")},
        farthest_{config.positive("farthest", "m")},
        stream_{around.seed, "ranges"} {
    scale_ = config.not_negative("scale_error", "") * stream_.normal();
    if (!config.has("shadow")) return;
    const Config shadow = config.section("shadow");
    least_cosine_ = std::cos(shadow.positive("half_angle", "rad"));
    hidden_loss_ = probability(shadow, "loss");
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    Ranges sample{.utime = moment.utime};
    const Eigen::Vector3d p_WS = moment.p_WB + moment.R_WB * p_BS_;
    for (const model::Transponder& transponder : site_->transponders) {
      const double noise = noise_ * stream_.normal();
      const Eigen::Vector3d apart = transponder.p_W - p_WS;
      const bool hidden = apart.dot(moment.R_WB.col(0)) > least_cosine_ * apart.norm();
      const bool lost = stream_.chance(hidden ? hidden_loss_ : loss_), wild = stream_.chance(outlier_);
      const double longer = stream_.uniform(0.0, outlier_size_);  // an echo never comes early
      const double range = apart.norm();
      const bool valid = !lost && range <= farthest_;
      sample.range.push_back(valid ? range * (1.0 + scale_) + noise + (wild ? longer : 0.0) : 0.0);
      sample.valid.push_back(valid ? 1 : 0);
    }
    samples.emplace_back(std::move(sample));
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override { return {{"scale_error", scale_}}; }

 private:
  Eigen::Vector3d p_BS_;
  const model::Site* site_;
  double noise_, loss_, outlier_, outlier_size_, farthest_;
  RandomStream stream_;
  double scale_{};
  double least_cosine_{2.0}, hidden_loss_{};  // of the direction to a transponder and the bow; 2: nothing is hidden
};

}  // namespace

std::unique_ptr<Sensor> make_ranges(const Config& config, const Surroundings& around) {
  if (!around.vehicle->mounts.ranges) config.fail("rate", "the vehicle file has no sensors.ranges");
  auto sensor = std::make_unique<RangesSensor>(config, around);  // reads its section in any case
  if (around.site->transponders.empty()) return nullptr;
  return sensor;
}

}  // namespace fathom::simulation
