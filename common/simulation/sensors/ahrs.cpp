// Attitude and heading reference: rates, specific force at its own place, attitude; all turned into body axes as the
// driver does. Gyro and accelerometer: turn-on bias, a scale of each axis, white noise, and a random walk of the gyro's
// bias. Attitude: white noise on an error that wanders (first-order Gauss-Markov), heading apart from roll and pitch.
//   f_I = v_dot + w x v + w_dot x r + w x (w x r) - R_WB^T g e_z    (at rest, level: 0 0 -g)
// Not modelled: the instrument's own filter, vibration, magnetic disturbance by the thrusters.
#include <cmath>

#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class AhrsSensor final : public Sensor {
 public:
  AhrsSensor(const Config& config, const Surroundings& around)
      : mount_{*around.vehicle->mounts.ahrs},
        gravity_{around.site->gravity},
        period_{1.0 / config.positive("rate", "Hz")},
        gyro_noise_{config.not_negative("gyro_noise", "rad/s")},
        gyro_walk_{config.not_negative("gyro_bias_walk", "rad/s")},
        force_noise_{config.not_negative("force_noise", "m/s^2")},
        tilt_noise_{config.not_negative("tilt_noise", "rad")},
        tilt_wander_{config.not_negative("tilt_wander", "rad")},
        heading_noise_{config.not_negative("heading_noise", "rad")},
        heading_wander_{config.not_negative("heading_wander", "rad")},
        wander_time_{config.positive("wander_time", "s")},
        declination_{config.either("heading", "magnetic", "true") ? around.site->declination : 0.0},
        stream_{around.seed, "ahrs"} {
    gyro_bias_ = stream_.normal3(config.not_negative("gyro_bias", "rad/s"));
    force_bias_ = stream_.normal3(config.not_negative("force_bias", "m/s^2"));
    misalignment_ = quaternion_from_rotation_vector(stream_.normal3(config.not_negative("misalignment", "rad")));
    RandomStream scales{around.seed, "ahrs.scale"};  // apart, so that all other errors are those of a run without them
    gyro_scale_ = scales.normal3(config.not_negative("gyro_scale", ""));
    force_scale_ = scales.normal3(config.not_negative("force_scale", ""));
    for (double& each : wander_) each = stream_.normal();
  }

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const Eigen::Vector3d v = moment.nu.head<3>(), w = moment.nu.tail<3>();
    const Eigen::Vector3d& r = mount_.p_BS;
    const Eigen::Vector3d w_dot = moment.nu_dot.tail<3>();
    const Eigen::Vector3d a = moment.nu_dot.head<3>() + w.cross(v) + w_dot.cross(r) + w.cross(w.cross(r));
    const Eigen::Vector3d f = a - gravity_ * moment.R_WB.row(2).transpose();
    gyro_bias_ += stream_.normal3(gyro_walk_ * std::sqrt(period_));
    const double kept = std::exp(-period_ / wander_time_), fresh = std::sqrt(1.0 - kept * kept);
    for (double& each : wander_) each = kept * each + fresh * stream_.normal();
    const Eigen::Vector3d tilt = tilt_wander_ * Eigen::Vector3d{wander_[0], wander_[1], 0.0} +
                                 Eigen::Vector3d{tilt_noise_ * stream_.normal(), tilt_noise_ * stream_.normal(), 0.0};
    const double heading = heading_wander_ * wander_[2] + heading_noise_ * stream_.normal() - declination_;
    // Errors of the instrument's axes appear in body axes through the mounting that the driver takes out.
    const Eigen::Matrix3d skewed = misalignment_.toRotationMatrix();
    const auto told = [&](const Eigen::Vector3d& truth_B, const Eigen::Vector3d& scale, const Eigen::Vector3d& error) {
      const Eigen::Vector3d own = mount_.R_BS.transpose() * skewed * truth_B;
      return Eigen::Vector3d{skewed * truth_B + mount_.R_BS * (scale.cwiseProduct(own) + error)};
    };
    const Eigen::Vector3d gyro_error = gyro_bias_ + stream_.normal3(gyro_noise_);
    const Eigen::Vector3d force_error = force_bias_ + stream_.normal3(force_noise_);
    samples.emplace_back(Ahrs{.utime = moment.utime,
                              .w_WB_B = told(moment.nu_seen.tail<3>(), gyro_scale_, gyro_error),
                              .f_B = told(f, force_scale_, force_error),
                              .q_WB = (Eigen::Quaterniond{Eigen::AngleAxisd{heading, Eigen::Vector3d::UnitZ()}} *
                                       moment.q_WB * quaternion_from_rotation_vector(tilt))
                                          .normalized(),
                              .has_rates = true,
                              .has_specific_force = true,
                              .has_attitude = true});
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> drawn() const override {
    const Eigen::Vector3d gyro = mount_.R_BS * gyro_bias_, force = mount_.R_BS * force_bias_;
    return {
        {"gyro_bias_p", gyro.x()},           {"gyro_bias_q", gyro.y()},           {"gyro_bias_r", gyro.z()},
        {"force_bias_x", force.x()},         {"force_bias_y", force.y()},         {"force_bias_z", force.z()},
        {"gyro_scale_x", gyro_scale_.x()},   {"gyro_scale_y", gyro_scale_.y()},   {"gyro_scale_z", gyro_scale_.z()},
        {"force_scale_x", force_scale_.x()}, {"force_scale_y", force_scale_.y()}, {"force_scale_z", force_scale_.z()}};
  }

 private:
  model::Mount mount_;
  double gravity_, period_, gyro_noise_, gyro_walk_, force_noise_;
  double tilt_noise_, tilt_wander_, heading_noise_, heading_wander_, wander_time_, declination_;
  RandomStream stream_;
  Eigen::Vector3d gyro_bias_, force_bias_;
  Eigen::Vector3d gyro_scale_, force_scale_;  // shares, of the instrument's own axes
  Eigen::Quaterniond misalignment_;
  std::array<double, 3> wander_{};
};

}  // namespace

std::unique_ptr<Sensor> make_ahrs(const Config& config, const Surroundings& around) {
  if (!around.vehicle->mounts.ahrs) config.fail("rate", "the vehicle file has no sensors.ahrs");
  return std::make_unique<AhrsSensor>(config, around);
}

}  // namespace fathom::simulation
