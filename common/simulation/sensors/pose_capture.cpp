// Motion capture: pose of the body with white noise; marked invalid while a drop-out of its markers lasts.
#include "common/base/config.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {
namespace {

class PoseCaptureSensor final : public Sensor {
 public:
  PoseCaptureSensor(const Config& config, const Surroundings& around)
      : position_noise_{config.not_negative("position_noise", "m")},
        attitude_noise_{config.not_negative("attitude_noise", "rad")},
        stream_{around.seed, "pose_capture"} {}

  void measure(const Moment& moment, std::vector<Sample>& samples) override {
    const Eigen::Vector3d position = stream_.normal3(position_noise_), turn = stream_.normal3(attitude_noise_);
    samples.emplace_back(PoseCapture{.utime = moment.utime,
                                     .p_WB = moment.p_WB + position,
                                     .q_WB = (moment.q_WB * quaternion_from_rotation_vector(turn)).normalized()});
  }

 private:
  double position_noise_, attitude_noise_;
  RandomStream stream_;
};

}  // namespace

std::unique_ptr<Sensor> make_pose_capture(const Config& config, const Surroundings& around) {
  return std::make_unique<PoseCaptureSensor>(config, around);
}

}  // namespace fathom::simulation
