// A small vehicle in a small tank for closing the loop in a test: the model's forward dynamics with thruster limits, a
// state with the noise that an estimator leaves, and what a supervisor and an identifier make of it. No process, no
// LCM.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "common/excitation/supervisor.hpp"
#include "common/identification/identifier.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/site.hpp"
#include "common/model/thruster_allocation.hpp"

namespace fathom::test {

struct PlantOptions {
  unsigned seed{1};
  double velocity_noise{0.005};  ///< m/s, correlated over 0.1 s as an estimator's is
  double rate_noise{0.002};      ///< rad/s
  double position_noise{0.003};  ///< m
  std::vector<model::ActiveEffect> effects{};
  double lag{0.0};  ///< s from command to thrust
};

class TankPlant {
 public:
  static constexpr double kStep = 0.01;  // s
  static constexpr Utime kStart = 1'700'000'000'000'000;

  TankPlant(const model::Vehicle& vehicle, const PlantOptions& options)
      : vehicle_{vehicle},
        options_{options},
        allocation_{vehicle, vehicle.largest_thrust},
        truth_{model::nominal_model(vehicle_, false)},
        random_{options.seed} {
    for (const auto& effect : options.effects) truth_.add(effect);
    memory_.assign(static_cast<std::size_t>(truth_.memory_size()), 0.0);
    force_ = model::ActuatorForces::Zero(static_cast<Eigen::Index>(vehicle_.thrusters.size()));
  }

  void command(const WrenchCommand& command) { command_ = command; }
  void step() {
    const bool alive = command_ && seconds_between(command_->utime, utime()) <= command_->life;
    const model::Allocated given = allocation_.allocate(alive ? command_->tau : Vector6d(Vector6d::Zero()), 0.0);
    applied_ = given;
    for (std::size_t i = 0; i < given.force.size(); ++i) force_[static_cast<Eigen::Index>(i)] = given.force[i];
    model::Motion begin = motion(nu_);
    model::feel(truth_, begin, memory_, 0.0);
    model::Motion middle = motion(nu_ + 0.5 * kStep * model::acceleration(truth_, begin));
    model::feel(truth_, middle, memory_, kStep);
    nu_dot_ = model::acceleration(truth_, middle);
    middle_nu_ = middle.nu;
    nu_ += kStep * nu_dot_;
    p_WB_ += kStep * (q_WB_ * middle_nu_.head<3>());
    q_WB_ = (q_WB_ * quaternion_from_rotation_vector(kStep * middle_nu_.tail<3>())).normalized();
    ++steps_;
  }
  [[nodiscard]] StateEstimate state() {
    const double keep = std::exp(-kStep / 0.1), fresh = std::sqrt(1.0 - keep * keep);
    for (Eigen::Index i = 0; i < 3; ++i)
      velocity_error_[i] = keep * velocity_error_[i] + fresh * options_.velocity_noise * normal_(random_);
    StateEstimate s{.utime = utime(), .p_WB = p_WB_, .q_WB = q_WB_, .nu = nu_, .valid = true};
    for (Eigen::Index i = 0; i < 3; ++i) {
      s.p_WB[i] += options_.position_noise * normal_(random_);
      s.nu[i] += velocity_error_[i];
      if (vehicle_.dof[static_cast<std::size_t>(3 + i)]) s.nu[3 + i] += options_.rate_noise * normal_(random_);
    }
    return s;
  }
  /// What was applied in the last step, stamped with its beginning.
  [[nodiscard]] Thrusters thrusters() const {
    Thrusters t{.utime = utime() - 10'000, .pwm_us = {}, .force = applied_.force, .has_tau = true};
    std::copy(applied_.tau.begin(), applied_.tau.end(), t.tau.begin());
    return t;
  }
  [[nodiscard]] Utime utime() const { return kStart + steps_ * 10'000; }
  [[nodiscard]] double seconds() const { return static_cast<double>(steps_) * kStep; }
  [[nodiscard]] const Eigen::Vector3d& position() const { return p_WB_; }
  [[nodiscard]] const Eigen::Quaterniond& attitude() const { return q_WB_; }
  [[nodiscard]] const Vector6d& nu() const { return nu_; }
  [[nodiscard]] const Vector6d& nu_dot() const { return nu_dot_; }
  [[nodiscard]] const Vector6d& middle_nu() const { return middle_nu_; }
  [[nodiscard]] const model::Allocated& applied() const { return applied_; }
  [[nodiscard]] const model::Model& truth() const { return truth_; }
  void place(const Eigen::Vector3d& p_WB) { p_WB_ = p_WB; }
  /// Least distance of the hull's corners from any wall, floor and surface [m]; negative: contact.
  [[nodiscard]] double room(const model::Site& site) const {
    double least = 1e9;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d sign{corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5};
      const Eigen::Vector3d p = p_WB_ + q_WB_ * sign.cwiseProduct(vehicle_.hull);
      least = std::min({least, site.north - p.x(), p.x() - site.south, site.east - p.y(), p.y() - site.west,
                        site.floor - p.z(), p.z() - site.surface});
    }
    return least;
  }

 private:
  [[nodiscard]] model::Motion motion(const Vector6d& nu) const {
    model::Motion m{.t = seconds(), .p_WB = p_WB_, .R_WB = q_WB_.toRotationMatrix(), .nu = nu};
    m.force = force_;
    m.vehicle = &vehicle_;
    return m;
  }
  model::Vehicle vehicle_;
  PlantOptions options_;
  model::ThrusterAllocation allocation_;
  model::Model truth_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<double> memory_;
  model::ActuatorForces force_;
  model::Allocated applied_;
  std::optional<WrenchCommand> command_;
  Eigen::Vector3d p_WB_{0.5, -0.3, 0.6};
  Eigen::Quaterniond q_WB_{Eigen::Quaterniond::Identity()};
  Vector6d nu_{Vector6d::Zero()}, nu_dot_{Vector6d::Zero()}, middle_nu_{Vector6d::Zero()};
  Eigen::Vector3d velocity_error_{Eigen::Vector3d::Zero()};
  std::int64_t steps_{0};
};

inline constexpr std::int64_t kChallenge = 4711;  ///< of the thrusters

/// Of the last order, of whatever test.
inline std::int64_t& last_number() {
  static std::int64_t number = 0;
  return number;
}

/// A supervisor that has heard who moves the thrusters.
inline excitation::Supervisor ready(const excitation::SupervisorSettings& settings, const model::Vehicle& vehicle) {
  excitation::Supervisor supervisor{settings, vehicle};
  supervisor.hear(Answer{.gate = true, .challenge = kChallenge, .accepted = last_number(), .authentic = true});
  return supervisor;
}

/// One after the other: each has a number of its own, above those before.
inline Operator order_to_arm(Utime utime) {
  return {.utime = utime,
          .sequence = ++last_number(),
          .challenge = kChallenge,
          .enable = true,
          .order = "identify",
          .authentic = true};
}

}  // namespace fathom::test
