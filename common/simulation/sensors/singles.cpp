// Accelerometers and gyros that stand singly in the hull, each a column of its own (SIGNAL): what the observation
// models (common/model/sensors) foretell of the truth, a bias drawn per run, and white noise. Not modelled: scale,
// misalignment.
#include "common/base/config.hpp"
#include "common/model/sensors/accelerometer.hpp"
#include "common/model/sensors/gyro.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

using Mount = model::SingleInertialMount;

double foretold(const Moment& moment, const Mount& mount, double gravity) {
  namespace at = model::at;
  const bool force = mount.measures == Mount::Measures::kForce;
  const Eigen::Vector3d v = moment.nu.head<3>(), w = moment.nu.tail<3>();
  model::KinematicVector x = model::KinematicVector::Zero();
  x.segment<3>(at::kAcceleration) = moment.nu_dot.head<3>() + w.cross(v);
  x.segment<3>(at::kRates) = (force ? moment.nu : moment.nu_seen).tail<3>();
  x.segment<3>(at::kRateSlopes) = moment.nu_dot.tail<3>();
  const model::KinematicPoint point{x, moment.R_WB};
  const model::Observation of_nothing =
      force ? observe(point, model::Accelerometer{mount.p_BS, mount.axis_B, -1, gravity}, 0.0, 1.0)
            : observe(point, model::Gyro{mount.axis_B}, 0.0, 1.0);
  return -of_nothing.innovation;
}

class Singles final : public Sensor {
 public:
  Singles(const Config& config, const Surroundings& around, Mount::Measures measures, const char* section)
      : gravity_{around.site->gravity}, stream_{around.seed, section} {
    const char* unit = Mount{.measures = measures}.unit();
    noise_ = config.not_negative("noise", unit);
    const double bias = config.not_negative("bias", unit);
    for (const Mount& mount : around.vehicle->mounts.singles) {
      if (mount.measures == measures) singles_.push_back({mount, bias * stream_.normal()});
    }
    if (singles_.empty()) config.fail("rate", "the vehicle file has no sensors." + std::string{section});
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    for (const Single& one : singles_) {
      samples.emplace_back(
          Signal{.utime = moment.utime,
                 .name = one.mount.signal,
                 .unit = one.mount.unit(),
                 .value = foretold(moment, one.mount, gravity_) + one.bias + noise_ * stream_.normal()});
    }
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    std::vector<std::pair<std::string, double>> biases;
    for (const Single& one : singles_) biases.emplace_back("bias of " + one.mount.signal, one.bias);
    return biases;
  }

 private:
  struct Single {
    Mount mount;
    double bias{};  // of its unit
  };
  double gravity_, noise_{};
  RandomStream stream_;
  std::vector<Single> singles_;
};

}  // namespace

std::unique_ptr<Sensor> make_accelerometers(const Config& config, const Surroundings& around) {
  return std::make_unique<Singles>(config, around, Mount::Measures::kForce, "accelerometers");
}

std::unique_ptr<Sensor> make_gyros(const Config& config, const Surroundings& around) {
  return std::make_unique<Singles>(config, around, Mount::Measures::kRate, "gyros");
}

}  // namespace fathom::simulation
