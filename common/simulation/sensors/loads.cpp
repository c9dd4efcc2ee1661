// Load cells: the pull of the tether, or the thrust of one thruster, along the cell's axis; white noise, a zero error
// and a gain drawn per run. Without a hidden tether the tether's cells show their zero. A vehicle of derivatives has
// the cells that its section `hydrodynamics` names, at thrusters, umbilical and chain.
#include <algorithm>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class LoadsSensor final : public Sensor {
 public:
  LoadsSensor(const Config& config, const Surroundings& around)
      : vehicle_{around.vehicle}, noise_{config.not_negative("noise", "N")}, stream_{around.seed, "loads"} {
    const auto thruster = [&](const std::string& name) {
      const auto& all = vehicle_->thrusters;
      return std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == name; }) - all.begin();
    };
    for (const model::LoadCellMount& cell : vehicle_->mounts.loads) {
      const bool tether = cell.of == "tether";
      cells_.push_back({cell.name, cell.axis_B, tether ? Of::kTether : Of::kThruster, tether ? 0 : thruster(cell.of)});
    }
    if (cells_.empty()) {
      std::ptrdiff_t next = 0;
      for (const model::LoadCell& cell : vehicle_->hydrodynamics->load_cells) {
        if (cell.of == "thrusters") {
          cells_.push_back({cell.name, cell.axis_B, Of::kThruster, next++});
        } else {
          cells_.push_back({cell.name, cell.axis_B, cell.of == "chain" ? Of::kChain : Of::kUmbilical});
        }
      }
    }
    const double zero = config.not_negative("zero_error", "N");
    const double gain = config.has("gain_error") ? config.not_negative("gain_error", "") : 0.0;
    for (Cell& cell : cells_) {
      cell.zero = zero * stream_.normal();
      if (gain > 0.0) cell.gain += gain * stream_.normal();
    }
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    Loads sample{.utime = moment.utime};
    for (const Cell& cell : cells_) {
      sample.load.push_back(cell.gain * cell.axis_B.dot(pull(cell, moment)) + cell.zero + noise_ * stream_.normal());
    }
    samples.emplace_back(std::move(sample));
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    std::vector<std::pair<std::string, double>> all;
    for (const Cell& cell : cells_) {
      all.emplace_back("zero_" + cell.name, cell.zero);
      if (cell.gain != 1.0) all.emplace_back("gain_" + cell.name, cell.gain);
    }
    return all;
  }

 private:
  enum class Of { kTether, kThruster, kUmbilical, kChain };
  struct Cell {
    std::string name;
    Eigen::Vector3d axis_B;
    Of of;
    std::ptrdiff_t thruster{};
    double zero{}, gain{1.0};
  };
  [[nodiscard]] Eigen::Vector3d pull(const Cell& cell, const Moment& moment) const {
    if (cell.of == Of::kTether) return moment.tether_B;
    if (cell.of == Of::kUmbilical) return moment.umbilical_B;
    if (cell.of == Of::kChain) return moment.chain_B;
    return moment.felt[cell.thruster] * vehicle_->thrusters[static_cast<std::size_t>(cell.thruster)].axis_B;
  }

  const model::Vehicle* vehicle_;
  double noise_;
  RandomStream stream_;
  std::vector<Cell> cells_;
};

}  // namespace

std::unique_ptr<Sensor> make_loads(const Config& config, const Surroundings& around) {
  const auto& h = around.vehicle->hydrodynamics;
  if (around.vehicle->mounts.loads.empty() && (!h || h->load_cells.empty())) {
    config.fail("rate", "the vehicle file has no sensors.loads");
  }
  return std::make_unique<LoadsSensor>(config, around);
}

}  // namespace fathom::simulation
