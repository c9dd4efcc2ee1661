// Wrench on one axis in proportion to a product of two velocities: the terms of the standard equations of motion. Asked
// of craft whose hull meets the water in one direction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/model/effect.hpp"
#include "common/model/hull_in_flow.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

class SpeedProduct final : public Form {
 public:
  enum class Sense { kWithSign, kEitherWay };
  /// w_row = c nu_r,first nu_r,second, a square where both are the same; either way: with the size of the first alone.
  SpeedProduct(Eigen::Index row, Eigen::Index first, Eigen::Index second, Sense sense = Sense::kWithSign)
      : Form{{.sought = {0}, .unit = unit_of(row, first, second), .drawn = kDrawn}},
        row_{row},
        first_{first},
        second_{second},
        sense_{sense} {}
  FormName name(const Scene& scene) const override {
    const bool moves = scene.nu_rms[first_] > kLeastMotion && scene.nu_rms[second_] > kLeastMotion;
    return when(lives_by_flow(*scene.vehicle) && scene.vehicle->dof[static_cast<std::size_t>(row_)] && moves, label());
  }
  Starts starts(const Scene& scene) const override {
    const double product = std::max(scene.nu_rms[first_], kLeastMotion) * std::max(scene.nu_rms[second_], kLeastMotion);
    std::vector<double> start(parameters().size(), 0.0);
    start.front() = kStartShare * std::max(scene.tau_rms[row_], 1e-3) / product;
    return {start};
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[0] == 0.0) return;
    const Vector6d nu_r = motion.nu_r();
    const double first = sense_ == Sense::kEitherWay ? std::abs(nu_r[first_]) : nu_r[first_];
    load.wrench[row_] += theta[0] * first * nu_r[second_];
  }

 private:
  static constexpr double kLeastMotion = 0.02;  // m/s, rad/s RMS: less shows no product
  static constexpr double kDrawn = 0.2;        // of sigma: a hull that is simulated with more would not hold its course
  static constexpr double kStartShare = 0.02;  // of the thrust along that axis

  static std::string_view unit_of(Eigen::Index row, Eigen::Index first, Eigen::Index second) {
    const int turns = (first < 3 ? 0 : 1) + (second < 3 ? 0 : 1);
    constexpr std::array kForce{"N/(m/s)^2", "N/(m/s)/(rad/s)", "N/(rad/s)^2"};
    constexpr std::array kMoment{"N m/(m/s)^2", "N m/(m/s)/(rad/s)", "N m/(rad/s)^2"};
    return (row < 3 ? kForce : kMoment)[static_cast<std::size_t>(turns)];
  }
  [[nodiscard]] std::string label() const {
    const std::string first = kVelocityNames[static_cast<std::size_t>(first_)];
    return std::string{kAxisNames[static_cast<std::size_t>(row_)]} + "_" +
           (sense_ == Sense::kEitherWay ? "|" + first + "|" : first) +
           kVelocityNames[static_cast<std::size_t>(second_)];
  }

  Eigen::Index row_, first_, second_;
  Sense sense_;
};

}  // namespace fathom::model
