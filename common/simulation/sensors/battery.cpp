// Battery's voltage under load, as the thrusters' driver tells it. The voltage itself is part of the truth.
#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class BatterySensor final : public Sensor {
 public:
  BatterySensor(const Config& config, const Surroundings& around)
      : noise_{config.not_negative("noise", "V")}, stream_{around.seed, "battery"} {}

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    samples.emplace_back(Battery{.utime = moment.utime, .voltage = moment.voltage + noise_ * stream_.normal()});
  }

 private:
  double noise_;
  RandomStream stream_;
};

}  // namespace

std::unique_ptr<Sensor> make_battery(const Config& config, const Surroundings& around) {
  return std::make_unique<BatterySensor>(config, around);
}

}  // namespace fathom::simulation
