// What every simulated instrument has in common: the truth at an instant goes in, samples as its driver would publish
// them come out. One file per instrument in sensors/; rate, latency and drop-outs are the same for all and done here.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "common/model/motion.hpp"
#include "common/model/site.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/sensors.hpp"
#include "common/samples/truth.hpp"
#include "common/samples/vision.hpp"
#include "common/simulation/random.hpp"

namespace fathom {
class Config;
}

namespace fathom::simulation {

/// The camera's shutter: where it was. The picture is made by who has a renderer.
struct Exposure {
  Utime utime{};
  std::string camera;                             ///< name in the vehicle file
  Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};  ///< m
  Eigen::Matrix3d R_WC{Eigen::Matrix3d::Identity()};
};

using Sample = std::variant<Thrusters, Battery, Loads, Ahrs, Dvl, Depth, Usbl, Ranges, PoseCapture, TagPose,
                            OpticalFlow, LaserRange, Signal, Truth, Exposure>;

/// The truth at one instant.
struct Moment {
  Utime utime{};
  double t{};                                     ///< s from the run's start
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};  ///< m
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
  Eigen::Matrix3d R_WB{Eigen::Matrix3d::Identity()};
  Vector6d nu{Vector6d::Zero()};       ///< m/s, rad/s
  Vector6d nu_dot{Vector6d::Zero()};   ///< m/s^2, rad/s^2, in B
  Vector6d nu_seen{Vector6d::Zero()};  ///< nu as hidden sensor faults show it to gyro, velocity log and optical flow
  Eigen::Vector3d v_WF{Eigen::Vector3d::Zero()};      ///< m/s, the water in W
  model::ActuatorForces felt{};                       ///< N, of each thruster, as it reaches the water
  Vector6d tau_felt{Vector6d::Zero()};                ///< N, N m
  Eigen::Vector3d tether_B{Eigen::Vector3d::Zero()};  ///< N, pull of the tether, in B
  Eigen::Vector3d umbilical_B{Eigen::Vector3d::Zero()}, chain_B{Eigen::Vector3d::Zero()};  ///< N at the attachment
  double voltage{};         ///< V; 0 when the vehicle has no battery in the simulation
  const Thrusters* told{};  ///< what the thrusters were told last; nullptr before
};

/// What AHRS tells at any instant, as drivers and vision know it: between its samples, with the errors of the newest.
struct AhrsTold {
  Ahrs newest{};
  Eigen::Vector3d rate_error{Eigen::Vector3d::Zero()};                ///< rad/s, in B
  Eigen::Quaterniond attitude_error{Eigen::Quaterniond::Identity()};  ///< told = true * error
  [[nodiscard]] Eigen::Vector3d w_WB_B(const Moment& moment) const { return moment.nu.tail<3>() + rate_error; }
  [[nodiscard]] Eigen::Quaterniond q_WB(const Moment& moment) const { return moment.q_WB * attitude_error; }
  void hear(const Ahrs& sample, const Moment& moment) {
    newest = sample;
    rate_error = sample.w_WB_B - moment.nu.tail<3>();
    attitude_error = moment.q_WB.conjugate() * sample.q_WB;
  }
};

/// What an instrument is built from. Drivers remove lever arms with what `ahrs` tells, unless instruments are `raw`:
/// then a driver will do so, and each speaks for its own place.
struct Surroundings {
  const model::Vehicle* vehicle{};
  const model::Site* site{};
  std::uint64_t seed{};
  const AhrsTold* ahrs{};
  bool raw{false};
};

class Sensor {
 public:
  virtual ~Sensor() = default;
  /// Appends what a measurement at this instant gives; nothing when there is nothing to be seen.
  virtual void measure(const Moment& moment, std::vector<Sample>& samples) = 0;
  /// Numbers drawn for this run (biases, scales), for truth.json.
  [[nodiscard]] virtual std::vector<std::pair<std::string, double>> drawn() const { return {}; }
};

/// Rate, phase, latency, drop-outs.
class Timing {
 public:
  Timing(const Config& config, const std::string& name, std::uint64_t seed);
  /// Of what is told when it happens: no rate, no latency, no drop-outs.
  Timing() : stream_{0, ""}, jitters_{0, ""} {}
  /// When measurement number `count` is taken, from the run's start [us]: exact to the microsecond at every rate.
  [[nodiscard]] Utime taken(Utime start, std::int64_t count) const;
  /// Of the next sample, jitter included.
  [[nodiscard]] Utime latency();
  /// False while a drop-out lasts. To be asked once per measurement.
  [[nodiscard]] bool works(Utime utime);

 private:
  double rate_{};
  double phase_{};  ///< s after the run's start of the first one
  Utime latency_{};
  double jitter_{};           ///< s: a sample is up to so much later than the latency, any time as likely
  double drop_out_{};         ///< chance per measurement that a drop-out begins
  double drop_out_length_{};  ///< s, mean; exponentially distributed
  Utime silent_until_{};
  RandomStream stream_, jitters_;
};

/// Carried everywhere: without a section the driver tells what it sends.
inline constexpr char kThrusterFeedback[] = "thrusters";

/// The instruments of sensors/, by the name of their section.
using MakeSensor = std::unique_ptr<Sensor> (*)(const Config& config, const Surroundings& around);
struct SensorKind {
  const char* name;
  MakeSensor make;  ///< nullptr result: the site has nothing for it to see
  /// Pictures take the place of what is measured in them.
  enum class Pictures { kEither, kWithout, kWith } pictures{Pictures::kEither};
};
[[nodiscard]] const std::vector<SensorKind>& sensor_kinds();

[[nodiscard]] std::unique_ptr<Sensor> make_accelerometers(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_ahrs(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_battery(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_camera(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_depth(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_dvl(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_gyros(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_laser_range(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_loads(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_optical_flow(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_pose_capture(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_ranges(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_tag_pose(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_thrusters(const Config&, const Surroundings&);
[[nodiscard]] std::unique_ptr<Sensor> make_usbl(const Config&, const Surroundings&);

/// A probability: 0 to 1, written as "0.1" or "10 %".
[[nodiscard]] double probability(const Config& config, const std::string& key);

}  // namespace fathom::simulation
