// Steps and slow sines on every free axis, a weak pull back to the start so that the dive stays in a tank's reach, and
// midpoint integration.
#include "test/support/virtual_dive.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "common/model/vehicle.hpp"

namespace fathom::test {
namespace {

constexpr int kSines = 4;

class Excitation {
 public:
  Excitation(const model::Model& model, std::mt19937& random) : random_{random} {
    std::uniform_real_distribution<double> any{0.0, 1.0};
    for (int i = 0; i < 6; ++i) {
      const double speed = 0.4;  // m/s, rad/s
      const double restoring = i == 3 || i == 4 ? 0.1 * std::abs(model.theta[21]) : 0.0;
      strength_[i] = speed * (std::abs(model.theta[6 + i]) + speed * std::abs(model.theta[12 + i])) +
                     0.3 * model.theta[i] + restoring;
      for (auto& sine : sines_[static_cast<std::size_t>(i)]) {
        sine = {0.5 * (0.5 + any(random)), 2.0 * std::numbers::pi * (0.03 + 0.3 * any(random)),
                2.0 * std::numbers::pi * any(random)};
      }
    }
  }

  Vector6d at(double t) {
    std::uniform_real_distribution<double> any{-1.0, 1.0};
    Vector6d tau;
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (t >= until_[i]) {
        level_[i] = any(random_);
        until_[i] = t + 2.5 + 1.5 * any(random_);
      }
      tau[i] = level_[i];
      for (const auto& sine : sines_[k]) tau[i] += 0.5 * sine[0] * std::sin(sine[1] * t + sine[2]);
      tau[i] *= strength_[i];
    }
    return tau;
  }
  [[nodiscard]] const Vector6d& strength() const { return strength_; }

 private:
  std::mt19937& random_;
  Vector6d strength_, level_{Vector6d::Zero()}, until_{Vector6d::Zero()};
  std::array<std::array<std::array<double, 3>, kSines>, 6> sines_{};
};

}  // namespace

VirtualDive make_dive(const model::Vehicle& vehicle, const DiveSettings& settings) {
  std::mt19937 random{settings.seed};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  std::normal_distribution<double> normal;
  VirtualDive dive;
  dive.truth = model::nominal_model(vehicle, settings.wrench);
  for (double& value : dive.truth.theta) value *= 1.0 + settings.spread * any(random);
  for (const auto& effect : settings.effects) dive.truth.add(effect);
  Trial& trial = dive.trial;
  trial.name = "virtual";
  trial.dt = settings.dt;
  trial.observed = {true, true, true, true};
  trial.input_is_wrench = settings.wrench;
  trial.input_step = settings.dt;
  trial.nu_sigma << Eigen::Vector3d::Constant(settings.velocity_noise), Eigen::Vector3d::Constant(settings.rate_noise);
  Excitation excitation{dive.truth, random};

  const auto samples = static_cast<std::size_t>(std::lround(settings.duration / settings.dt)) + 1;
  const int substeps = static_cast<int>(std::lround(settings.dt / settings.step));
  const double h = settings.dt / substeps;
  const Eigen::MatrixXd allocation = dive.truth.allocation;
  Eigen::MatrixXd reachable = allocation;
  for (int i = 0; i < 6; ++i) {
    if (!vehicle.dof[static_cast<std::size_t>(i)]) reachable.row(i).setZero();
  }
  std::vector<int> free_axes;
  for (int i = 0; i < 6; ++i) {
    if (vehicle.dof[static_cast<std::size_t>(i)]) free_axes.push_back(i);
  }
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse{reachable};
  Vector6d nu = Vector6d::Zero();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  std::vector<double> memory(static_cast<std::size_t>(dive.truth.memory_size()), 0.0);
  // The command of the next sample is decided now, so that inputs run straight from sample to sample.
  const auto command = [&](double t) {
    Vector6d tau = excitation.at(t);
    if (settings.turn > 0.0) {
      const int driven = free_axes[static_cast<std::size_t>(t / settings.turn) % free_axes.size()];
      tau = (Vector6d::Unit(driven) * tau[driven]).eval();
      return Eigen::VectorXd{inverse.solve(Eigen::VectorXd{tau})};
    }
    tau.head<3>() -= (q.conjugate() * p).cwiseProduct(0.15 * excitation.strength().head<3>());
    return Eigen::VectorXd{inverse.solve(Eigen::VectorXd{tau})};
  };
  const double remembered = settings.noise_memory > 0.0 ? std::exp(-settings.dt / settings.noise_memory) : 0.0;
  std::vector<Vector6d> noises;
  model::VelocityTrace measured(6, static_cast<Eigen::Index>(samples));
  trial.input.reserve(samples + 1);
  trial.input.push_back(command(0.0));
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) * settings.dt;
    trial.input.push_back(command(t + settings.dt));
    const double voltage = 16.5 - 3.0 * t / settings.duration;
    trial.t.push_back(t);
    trial.p_WB.push_back(p);
    trial.q_WB.push_back(q);
    Vector6d noise;
    for (int i = 0; i < 6; ++i) noise[i] = trial.nu_sigma[i] * normal(random);
    if (k > 0) noise = remembered * noises.back() + std::sqrt(1.0 - remembered * remembered) * noise;
    noises.push_back(noise);
    measured.col(static_cast<Eigen::Index>(k)) = nu;
    trial.voltage.push_back(voltage);
    const model::InputSignal input{0.0, settings.dt, trial.input,
                                   {},  {},          {.hold = settings.input_hold, .step = settings.dt}};
    const auto motion_at = [&](double time, const Vector6d& velocity) {
      model::Motion motion{.t = time, .p_WB = p, .R_WB = q.toRotationMatrix(), .nu = velocity};
      input.now(time, motion.force);
      motion.voltage = voltage;
      motion.input = &input;
      motion.vehicle = &vehicle;
      return motion;
    };
    if (k == 0) model::settle(dive.truth, motion_at(0.0, nu), memory);
    for (int s = 0; s < substeps; ++s) {
      const double now = t + s * h;
      model::Motion begin = motion_at(now, nu);
      model::feel(dive.truth, begin, memory, 0.0);
      // Memories are advanced to the instant at which they are asked, with the command of the time in between.
      const Vector6d halfway = nu + 0.5 * h * model::acceleration(dive.truth, begin);
      model::Motion early = motion_at(now + 0.25 * h, nu);
      model::feel(dive.truth, early, memory, 0.5 * h);
      const Eigen::Quaterniond before = q;
      const Eigen::Vector3d from = p;
      p = from + 0.5 * h * (before * begin.nu.head<3>());
      q = before * quaternion_from_rotation_vector(0.5 * h * begin.nu.tail<3>());
      model::Motion middle = motion_at(now + 0.5 * h, halfway);
      model::feel(dive.truth, middle, memory, 0.0);
      nu += h * model::acceleration(dive.truth, middle);
      p = from + h * (q * halfway.head<3>());
      q = (before * quaternion_from_rotation_vector(h * halfway.tail<3>())).normalized();
      model::Motion late = motion_at(now + 0.75 * h, nu);
      model::feel(dive.truth, late, memory, 0.5 * h);
    }
  }
  model::VelocityView seen{measured};
  for (const auto& one : dive.truth.effects) {
    if (one.effect->measures()) one.effect->measure(seen, settings.dt, one.theta, one.variant);
  }
  for (std::size_t k = 0; k < samples; ++k) {
    trial.nu.emplace_back(measured.col(static_cast<Eigen::Index>(k)) + noises[k]);
  }
  trial.input.pop_back();
  trial.pose_valid.assign(samples, 1);
  trial.velocity_valid.assign(samples, 1);
  trial.rates_valid.assign(samples, 1);
  return dive;
}

model::Vehicle without_parameters(model::Vehicle vehicle, const std::string& beginning) {
  for (std::size_t i = vehicle.parameters.size(); i-- > 0;) {
    if (!vehicle.parameters[i].starts_with(beginning)) continue;
    vehicle.parameters.erase(vehicle.parameters.begin() + static_cast<std::ptrdiff_t>(i));
    vehicle.priors.erase(vehicle.priors.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return vehicle;
}

model::Vehicle vehicle_from_repository(const std::string& name) {
  return model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/" + name + ".yaml");
}

model::ActiveEffect active(const std::string& name, std::vector<double> theta, int variant) {
  const model::Effect* effect = model::find_effect(name);
  theta.resize(effect->parameters().size());
  return {effect, variant, "", std::move(theta)};
}

}  // namespace fathom::test
