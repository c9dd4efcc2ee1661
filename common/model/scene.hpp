// What a data set offers, and how large things are in it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/model/motion.hpp"

namespace fathom::model {

class Effect;

/// A force that swings with time alone: cosine cos(omega t) + sine sin(omega t), t from the run's start.
struct Tone {
  double omega{};                                   ///< rad/s
  Eigen::Vector3d cosine{Eigen::Vector3d::Zero()};  ///< N in W
  Eigen::Vector3d sine{Eigen::Vector3d::Zero()};
};

/// What a data set offers and how large things are in it. Effects choose their forms and starting points from it.
struct Scene {
  const Vehicle* vehicle{};
  bool position{false}, attitude{false}, velocity{false}, rates{false};  ///< which groups were measured
  /// A sensor that kinematics has compared with another is corrected before anything is fitted: forces need not be
  /// asked.
  [[nodiscard]] bool velocity_checked() const { return velocity && position && attitude; }
  [[nodiscard]] bool rates_checked() const { return rates && attitude; }
  bool input_is_wrench{false};  ///< inputs are the six axes of the wrench, not single thrusters
  bool voltage{false};
  int runs{1};               ///< whose clocks need not be the same
  double duration{};         ///< s, longest run
  double t_low{}, t_high{};  ///< s, times within the runs that the data covers; equal: not known beforehand
  double mean_voltage{};     ///< V
  double voltage_range{};    ///< V
  Eigen::Vector3d p_low{Eigen::Vector3d::Zero()}, p_high{Eigen::Vector3d::Zero()};  ///< m, box of positions
  Vector6d nu_rms{Vector6d::Zero()};
  Vector6d tau_rms{Vector6d::Zero()};
  ActuatorForces force_rms{};  ///< N per actuator
  double tilt_rms{};           ///< horizontal share of the body's down axis; 0 when attitude was not measured
  /// Oscillating forces that a linear regression leaves in the longest run, most prominent first; empty when not known.
  std::vector<Tone> tones_horizontal{}, tones_vertical{};
  std::span<const Effect* const> candidates{};  ///< effects of measured columns, asked beside the listed ones
};

}  // namespace fathom::model
