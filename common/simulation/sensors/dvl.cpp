// Doppler velocity log: four beams (Janus) meet the bottom or a wall; each tells its own velocity with white noise and
// may lose its echo. Three beams at least give the velocity by least squares. One scale error per run (speed of sound),
// one bias per axis. The driver turns it into body axes and takes the lever arm out with the rates that AHRS tells. Not
// modelled: water tracking, errors that grow with speed, side lobes.
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/config.hpp"
#include "common/base/factors.hpp"
#include "common/simulation/boundaries.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

constexpr double kFresh = 0.5;  // s: older rates are not used, as in the driver

class DvlSensor final : public Sensor {
 public:
  DvlSensor(const Config& config, const Surroundings& around)
      : mount_{around.vehicle->mounts.dvl->mount},
        site_{around.site},
        ahrs_{around.ahrs},
        raw_{around.raw},
        noise_{config.not_negative("beam_noise", "m/s")},
        loss_{probability(config, "beam_loss")},
        nearest_{config.not_negative("nearest", "m")},
        farthest_{config.positive("farthest", "m")},
        stream_{around.seed, "dvl"} {
    const double tilt = around.vehicle->mounts.dvl->beam_angle;
    for (int i = 0; i < 4; ++i) {
      const double azimuth = 0.5 * std::numbers::pi * i;
      beams_.row(i) << std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt);
    }
    scale_ = config.not_negative("scale_error", "") * stream_.normal();
    bias_ = stream_.normal3(config.not_negative("bias", "m/s"));
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const Eigen::Matrix3d R_WS = moment.R_WB * mount_.R_BS;
    const Eigen::Vector3d p_WS = moment.p_WB + moment.R_WB * mount_.p_BS;
    const Eigen::Vector3d w = moment.nu.tail<3>();
    const Eigen::Vector3d v_S =
        mount_.R_BS.transpose() * (moment.nu_seen.head<3>() + w.cross(mount_.p_BS)) * (1.0 + scale_) + bias_;
    Eigen::Matrix<double, 4, 3> rows = Eigen::Matrix<double, 4, 3>::Zero();
    Eigen::Vector4d along = Eigen::Vector4d::Zero();
    int good = 0;
    double altitude = 0.0;
    for (int i = 0; i < 4; ++i) {
      const double noise = noise_ * stream_.normal();
      const bool lost = stream_.chance(loss_);
      const Eigen::Vector3d beam = beams_.row(i).transpose();
      const double range = distance_along(*site_, p_WS, R_WS * beam);
      if (lost || range < nearest_ || range > farthest_) continue;
      rows.row(i) = beams_.row(i);
      along[i] = beam.dot(v_S) + noise;
      altitude += range * beam.z();
      ++good;
    }
    Dvl sample{.utime = moment.utime, .valid = false};
    const bool arm = !raw_ && !mount_.p_BS.isZero();
    const bool rates =
        arm && ahrs_->newest.has_rates && std::abs(seconds_between(ahrs_->newest.utime, moment.utime)) <= kFresh;
    if (good >= 3 && (rates || !arm)) {
      const Eigen::Matrix3d normal = rows.transpose() * rows;
      const Eigen::Vector3d v = solve_symmetric(normal, rows.transpose() * along);
      sample.v_WB_B = mount_.R_BS * v;
      if (arm) sample.v_WB_B -= ahrs_->w_WB_B(moment).cross(mount_.p_BS);
      sample.altitude = altitude / good;
      sample.valid = true;
    }
    samples.emplace_back(sample);
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    return {{"scale_error", scale_}, {"bias_x", bias_.x()}, {"bias_y", bias_.y()}, {"bias_z", bias_.z()}};
  }

 private:
  model::Mount mount_;
  const model::Site* site_;
  const AhrsTold* ahrs_;
  bool raw_;
  double noise_, loss_, nearest_, farthest_;
  RandomStream stream_;
  Eigen::Matrix<double, 4, 3> beams_;
  double scale_{};
  Eigen::Vector3d bias_;
};

}  // namespace

std::unique_ptr<Sensor> make_dvl(const Config& config, const Surroundings& around) {
  if (!around.vehicle->mounts.dvl) config.fail("rate", "the vehicle file has no sensors.dvl");
  return std::make_unique<DvlSensor>(config, around);
}

}  // namespace fathom::simulation
