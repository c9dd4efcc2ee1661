// What is compared: base numbers, effects, a free force, and what belongs to each run alone; and all of it as one list
// of free numbers with priors.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/likelihood/features.hpp"
#include "common/model/dynamics.hpp"

namespace fathom::likelihood {

/// What belongs to one run.
struct RunNumbers {
  double command_offset{};  ///< s by which thrust acts later than its stamp says: two clocks, and how commands are held
  Eigen::Vector3d world_force{Eigen::Vector3d::Zero()};  ///< N, fixed in W
  Vector6d velocity_bias{Vector6d::Zero()};              ///< m/s, rad/s: measured less true
};

struct Hypothesis {
  model::Model model;
  FreeForce force;
  std::vector<RunNumbers> runs;
};

enum class NumberKind { kBase, kEffect, kWeight, kCommandOffset, kWorldForce, kVelocityBias };

/// One free number.
struct Number {
  NumberKind kind{};
  int index{};      ///< of the base parameter, effect, feature or axis
  int component{};  ///< of the effect's numbers
  int run{-1};      ///< -1: of all runs
  std::string name, unit;
  double mean{}, sigma{1.0};  ///< prior
  /// Of Student's t as the prior; zero: Gaussian. What an effect's number ordinarily is goes with the craft's speed and
  /// size, so that the width itself is known to an order of magnitude only.
  double freedom{};
  double low{-std::numeric_limits<double>::infinity()}, high{std::numeric_limits<double>::infinity()};
  double step{};  ///< of differences
};

struct NumberSettings {
  bool command_offset{true}, world_force{false};
  bool velocity_bias{false};
  double offset_sigma{5e-3};  ///< s; plus a part of the step between inputs, as how they are held is not known
  double offset_of_step{0.1};
  double world_force_sigma{1.0};  ///< N
  double bias_sigma{0.01};        ///< m/s, rad/s
};

/// Free numbers of a hypothesis, in order: base, effects, free force, runs. `t_low`, `t_high`: of the data, for onsets.
[[nodiscard]] std::vector<Number> numbers_of(const Hypothesis& hypothesis, const NumberSettings& settings,
                                             double input_step, double t_low, double t_high);

/// The model of a hypothesis, without its free force; the thrust's offset (mean over runs) as a delay that straight
/// lines between inputs, `input_step` s apart, can carry.
[[nodiscard]] model::Model model_of(const Hypothesis& hypothesis, double input_step);

[[nodiscard]] double& at(Hypothesis& hypothesis, const Number& number);
[[nodiscard]] double value(const Hypothesis& hypothesis, const Number& number);
[[nodiscard]] Eigen::VectorXd values(const Hypothesis& hypothesis, const std::vector<Number>& numbers);
void set_values(Hypothesis& hypothesis, const std::vector<Number>& numbers, const Eigen::VectorXd& values);
/// Log density of a number's prior, constants included.
[[nodiscard]] double log_prior(const Number& number, double value);
/// Weight of the prior in the normal equations there: slope of its log density over the distance from its mean, with
/// the other sign. It is that of a Gaussian, and positive everywhere.
[[nodiscard]] double prior_weight(const Number& number, double value);
/// Log density of all priors at their numbers.
[[nodiscard]] double log_prior(const std::vector<Number>& numbers, const Eigen::VectorXd& values);

}  // namespace fathom::likelihood
