// A free force: weights times functions of a model's own state and of what drives it. Weights are numbers of the
// fit with one Gaussian prior per group, so that a learned force is part of a model like any effect.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/motion.hpp"

namespace fathom::model {

/// Time constants of the low passes that features may run over, s.
constexpr std::array kThrustMemories{0.05, 0.15, 0.4, 1.2};
constexpr std::array kVelocityMemories{0.4, 1.5, 4.0};

/// What features read at one instant.
struct FeatureState {
  double t{};  ///< s
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d R_WB{Eigen::Matrix3d::Identity()};
  double heading_cosine{1.0}, heading_sine{0.0};
  Vector6d nu{Vector6d::Zero()};
  Vector6d tau{Vector6d::Zero()};  ///< wrench of the actuators as they reach the water
  model::ActuatorForces force{};   ///< N
  std::array<Vector6d, kThrustMemories.size()> slow_tau{};
  std::array<Vector6d, kVelocityMemories.size()> slow_nu{};
};

enum class Quantity : std::uint8_t {
  kVelocity,  ///< of axis `index`
  kSpeed,     ///< its size
  kWrench,    ///< of axis `index`
  kWrenchSize,
  kThruster,  ///< force of actuator `index`
  kThrusterSize,
  kSlowWrench,  ///< of axis `index` through low pass `bank`
  kSlowVelocity,
  kDepthBump,      ///< Gaussian about a, width b
  kPlanBump,       ///< about (a, b), width c
  kHeadingCosine,  ///< of `index` times the heading
  kHeadingSine,
  kAfter,       ///< smooth step at a, over b seconds
  kToneCosine,  ///< of a rad/s
  kToneSine,
  kFlowSpeed,  ///< size of u, v and w together
  kPowerOdd,   ///< of the velocity of axis `index`, its sign kept: exponent a
  kPowerEven,  ///< of its size
  kRamp        ///< (t - a) / b
};
/// As result.json names it.
[[nodiscard]] std::string_view word(Quantity quantity);
[[nodiscard]] std::optional<Quantity> quantity_from(std::string_view word);

struct Factor {
  Quantity quantity{};
  int index{}, bank{};
  double a{}, b{1.0}, c{1.0};
};

/// Axes of a feature: X..N of the body, then north, east and down of the world.
constexpr int kWorldAxis = 6;

struct Feature {
  int axis{};
  int count{};  ///< of factors
  std::array<Factor, 3> factors{};
  double scale{1.0};
  /// Scaled value, N or N m.
  [[nodiscard]] double value(const FeatureState& state) const;
  [[nodiscard]] bool moves_with_velocity() const;
  [[nodiscard]] bool depends_on_time() const;
  [[nodiscard]] bool remembers() const;  ///< reads low passes
  void add(const FeatureState& state, double weight, Vector6d& wrench) const;
};

struct FeatureGroup {
  std::string kind;  ///< in words: "depth", "thrust a moment ago"
  int axis{};
  int first{}, count{};  ///< of the features
  double sigma{0.05};    ///< of its weights
  bool searched{false};  ///< its moment or frequency was sought in the data
};

struct FreeForce {
  std::vector<Feature> features;
  std::vector<FeatureGroup> groups;
  std::vector<double> weights;
  [[nodiscard]] bool empty() const { return features.empty(); }
  [[nodiscard]] Vector6d wrench(const FeatureState& state) const;
};

}  // namespace fathom::model
