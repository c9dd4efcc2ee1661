// Feedback of the thrusters, as of drives that report their shafts' speed: what was sent and is applied, read at a rate
// of its own with white noise and a gain that is drawn per thruster. Without this section the driver tells what it
// sends, exactly and at once. Not modelled: the shaft's own lag, which is an effect (thruster_lag).
#include <algorithm>
#include <utility>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class ThrusterFeedback final : public Sensor {
 public:
  ThrusterFeedback(const Config& config, const Surroundings& around)
      : vehicle_{around.vehicle}, noise_{config.not_negative("noise", "N")}, stream_{around.seed, "thrusters"} {
    const double error = config.not_negative("gain_error", "");
    for (std::size_t i = 0; i < vehicle_->thrusters.size(); ++i) gain_.push_back(1.0 + error * stream_.normal());
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    if (moment.told == nullptr || moment.told->force.size() != gain_.size()) return;
    Thrusters told = *moment.told;
    told.utime = moment.utime;
    Vector6d tau = Vector6d::Zero();
    for (std::size_t i = 0; i < gain_.size(); ++i) {
      // A drive that stands still knows it.
      if (told.force[i] != 0.0) told.force[i] = gain_[i] * told.force[i] + noise_ * stream_.normal();
      tau += vehicle_->allocation.col(static_cast<Eigen::Index>(i)) * told.force[i];
    }
    std::copy(tau.begin(), tau.end(), told.tau.begin());
    samples.emplace_back(std::move(told));
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    std::vector<std::pair<std::string, double>> all;
    for (std::size_t i = 0; i < gain_.size(); ++i) all.emplace_back("gain_" + vehicle_->thrusters[i].name, gain_[i]);
    return all;
  }

 private:
  const model::Vehicle* vehicle_;
  double noise_;
  RandomStream stream_;
  std::vector<double> gain_;
};

}  // namespace

std::unique_ptr<Sensor> make_thrusters(const Config& config, const Surroundings& around) {
  if (around.vehicle->thrusters.empty()) config.fail("rate", "the vehicle file has no thrusters");
  return std::make_unique<ThrusterFeedback>(config, around);
}

}  // namespace fathom::simulation
