#include "test/support/trial_recording.hpp"

#include <cmath>
#include <random>
#include <vector>

#include "common/base/config.hpp"

namespace fathom::test {
namespace {

constexpr Utime kOrigin = 1'700'000'000'000'000;  // us
constexpr double kMemory = 1.0;                   // s, of the umbilical's disturbance
constexpr double kAhead =
    0.8;  // direction cosine: the hull hides what lies farther ahead than this from the transducer
constexpr double kHidden = 0.9;  // share of the hidden ranges that are lost
constexpr double kAttitudeEvery = 0.1, kDepthEvery = 0.1, kLoadEvery = 0.02;  // s

class Dice {
 public:
  Dice(unsigned seed, bool noise) : random_{seed}, noise_{noise} {}
  double normal() { return noise_ ? normal_(random_) : 0.0; }
  Eigen::Vector3d vector() { return {normal(), normal(), normal()}; }
  bool happens(double share) { return noise_ && any_(random_) < share; }
  double between(double low, double high) { return low + (high - low) * any_(random_); }

 private:
  std::mt19937 random_;
  bool noise_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> any_{0.0, 1.0};
};

bool due(double t, double every) { return std::abs(t / every - std::round(t / every)) < 1e-6; }

Ranges ranges_at(const model::FlightMoment& moment, const estimation::KalmanSettings& instruments,
                 const TrialSettings& settings, Dice& dice) {
  Ranges ranges;
  const Eigen::Vector3d p_WA = moment.p_WB + moment.q_WB * instruments.p_BA;
  for (const estimation::Transponder& one : instruments.transponders) {
    const Eigen::Vector3d apart = one.p_WT - p_WA;
    const double ahead = (moment.q_WB.conjugate() * apart).x() / apart.norm();
    double range = apart.norm() + instruments.range_noise * dice.normal();
    if (dice.happens(settings.outliers)) range += dice.between(1.0, 10.0);
    const bool lost = dice.happens(ahead > kAhead ? kHidden : settings.drop_outs);
    ranges.range.push_back(lost ? 0.0 : range);
    ranges.valid.push_back(lost ? 0 : 1);
  }
  return ranges;
}

}  // namespace

TrialRecording record_trial(const model::Vehicle& vehicle, const estimation::KalmanSettings& instruments,
                            const TrialSettings& settings) {
  Dice dice{settings.seed, settings.noise};
  TrialRecording trial;
  trial.accelerometer_bias = instruments.accelerometer_bias * dice.vector();
  trial.gyro_bias = instruments.gyro_bias * dice.vector();

  std::vector<Eigen::Vector3d> pull{Eigen::Vector3d::Zero()};
  const double decay = std::exp(-0.01 / kMemory);
  for (double t = 0.0; t < settings.manoeuvre.duration + 1.0; t += 0.01) {
    const double still = t < settings.manoeuvre.rest ? 0.0 : settings.disturbance;  // a slack line does not pull
    pull.push_back(decay * pull.back() + still * std::sqrt(1.0 - decay * decay) * dice.vector());
  }
  const double dt = 1.0 / settings.inertial_rate;
  trial.flight = model::fly(vehicle, settings.manoeuvre, dt,
                            [&](double t) { return pull[static_cast<std::size_t>(std::lround(t / 0.01))]; });

  std::vector<double> gain;
  for (std::size_t i = 0; i < vehicle.hydrodynamics->load_cells.size(); ++i) {
    gain.push_back(1.0 + settings.cell_gain * dice.normal());
  }
  Recording& r = trial.recording;
  r.name = "trial";
  for (const model::FlightMoment& m : trial.flight) {
    const Utime utime = utime_after(kOrigin, m.t);
    const Eigen::Vector3d v = m.nu.head<3>(), w = m.nu.tail<3>(), w_dot = m.nu_dot.tail<3>();
    const Eigen::Vector3d down = m.q_WB.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d a_I =
        m.nu_dot.head<3>() + w.cross(v) + w.cross(w.cross(instruments.p_BI)) + w_dot.cross(instruments.p_BI);
    Ahrs ahrs{.utime = utime, .has_rates = true, .has_specific_force = true};
    ahrs.f_B = instruments.R_BI.transpose() * (a_I - model::kGravity * down) + trial.accelerometer_bias +
               instruments.accelerometer_noise.cwiseProduct(dice.vector());
    ahrs.w_WB_B =
        instruments.R_BI.transpose() * w + trial.gyro_bias + instruments.gyro_noise.cwiseProduct(dice.vector());
    if (due(m.t, kAttitudeEvery)) {
      Eigen::Vector3d euler = euler_from_rotation(m.q_WB.toRotationMatrix());
      euler.head<2>() += settings.inclinometer * dice.vector().head<2>();
      euler.z() += instruments.heading_noise.value_or(estimation::KalmanSettings::kHeadingNoise) * dice.normal() -
                   instruments.declination;
      ahrs.q_WB = Eigen::Quaterniond{rotation_from_euler(euler)};
      ahrs.has_attitude = true;
    }
    r.ahrs.push_back(ahrs);
    if (due(m.t, kDepthEvery)) {
      r.depth.push_back({utime, m.p_WB.z() + down.dot(instruments.p_BP) + instruments.depth_noise * dice.normal()});
    }
    if (due(m.t, 1.0 / settings.range_rate)) {
      r.ranges.push_back(ranges_at(m, instruments, settings, dice));
      r.ranges.back().utime = utime;
    }
    if (due(m.t, kLoadEvery)) {
      Loads loads{.utime = utime};
      std::size_t thruster = 0;
      for (std::size_t i = 0; i < gain.size(); ++i) {
        const model::LoadCell& cell = vehicle.hydrodynamics->load_cells[i];
        const double load = cell.of == "thrusters"   ? m.thrust[thruster++]
                            : cell.of == "umbilical" ? cell.axis_B.dot(m.F_umbilical_B)
                                                     : cell.axis_B.dot(m.F_chain_B);
        loads.load.push_back(gain[i] * load + settings.cell_noise * dice.normal());
      }
      r.loads.push_back(loads);
      r.thrusters.push_back({.utime = utime, .force = m.thrust});
    }
    Truth truth{.utime = utime, .p_WB = m.p_WB, .q_WB = m.q_WB, .nu = m.nu, .nu_dot = m.nu_dot};
    truth.tau_felt = vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(m.thrust.data());
    r.truth.push_back(truth);
  }
  return trial;
}

estimation::KalmanSettings instruments_from_repository(const std::string& name) {
  const Config config = Config::load(std::string{FATHOM_SOURCE_DIR} + "/config/pipelines/" + name + ".yaml");
  return estimation::KalmanSettings::from(config.section("estimator"));
}

}  // namespace fathom::test
