// Load cells: the pull of the tether, or the thrust of one thruster, along the cell's axis; white noise and a zero
// error drawn per run. Without a hidden tether the tether's cells show their zero.
#include <algorithm>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class LoadsSensor final : public Sensor {
 public:
  LoadsSensor(const Config& config, const Surroundings& around)
      : vehicle_{around.vehicle}, noise_{config.not_negative("noise", "N")}, stream_{around.seed, "loads"} {
    const double zero = config.not_negative("zero_error", "N");
    for (std::size_t i = 0; i < vehicle_->mounts.loads.size(); ++i) zero_.push_back(zero * stream_.normal());
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    Loads sample{.utime = moment.utime};
    for (std::size_t i = 0; i < zero_.size(); ++i) {
      const model::LoadCellMount& cell = vehicle_->mounts.loads[i];
      sample.load.push_back(cell.axis_B.dot(pull(cell, moment)) + zero_[i] + noise_ * stream_.normal());
    }
    samples.emplace_back(std::move(sample));
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    std::vector<std::pair<std::string, double>> zeros;
    for (std::size_t i = 0; i < zero_.size(); ++i)
      zeros.emplace_back("zero_" + vehicle_->mounts.loads[i].name, zero_[i]);
    return zeros;
  }

 private:
  [[nodiscard]] Eigen::Vector3d pull(const model::LoadCellMount& cell, const Moment& moment) const {
    if (cell.of == "tether") return moment.tether_B;
    const auto& thrusters = vehicle_->thrusters;
    const auto found =
        std::find_if(thrusters.begin(), thrusters.end(), [&](const auto& each) { return each.name == cell.of; });
    return moment.felt[found - thrusters.begin()] * found->axis_B;
  }

  const model::Vehicle* vehicle_;
  double noise_;
  RandomStream stream_;
  std::vector<double> zero_;
};

}  // namespace

std::unique_ptr<Sensor> make_loads(const Config& config, const Surroundings& around) {
  if (around.vehicle->mounts.loads.empty()) config.fail("rate", "the vehicle file has no sensors.loads");
  return std::make_unique<LoadsSensor>(config, around);
}

}  // namespace fathom::simulation
