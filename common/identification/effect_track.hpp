// An effect that the identifier has taken into its model: its share of the wrench goes through the same windows as the
// motion, and its numbers become further columns of the rows.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "common/identification/rows.hpp"
#include "common/model/effect_wrench.hpp"

namespace fathom::identification {

/// All that an effect may depend on, at one instant.
struct EffectSample {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
  Vector6d nu{Vector6d::Zero()};
  Eigen::Vector3d sigma_v{Eigen::Vector3d::Zero()};  ///< m/s, of u v w
  model::ActuatorForces force;                       ///< N, as commanded
  double voltage{};                                  ///< V; 0: not known
  bool valid{false};                                 ///< false: a break in the motion
};

class EffectTrack {
 public:
  /// `origin`: zero of the effect's time. `capacity`: samples that a window can hold; `max_gap` [s] breaks the motion.
  /// `parameters`: the rows' columns before the effect's are appended.
  EffectTrack(const model::Model& base, model::ActiveEffect effect, std::span<const model::BaseParameter> parameters,
              Utime origin, std::size_t capacity, double max_gap);

  [[nodiscard]] const model::ActiveEffect& effect() const { return wrench_.effect(); }
  /// Places of its numbers that have columns, in their order.
  [[nodiscard]] const std::vector<std::size_t>& sought() const { return sought_; }
  /// Call with each sample that the regressor kept, and with each that is not valid.
  void step(const EffectSample& sample);
  /// Appends the effect's columns to the rows of the window that ends at the last sample, in units of its numbers, and
  /// moves what they must explain: with its numbers right, h . theta = y again. Where the effect alters what the hull
  /// feels, the base parameters' own columns are altered too. False when it has seen too little.
  [[nodiscard]] bool extend(RowBlock& block, std::span<const double> average, std::span<const double> derivative);

 private:
  void remember(const EffectSample& sample);

  model::EffectWrench wrench_;
  std::vector<std::size_t> sought_;
  ParameterVector base_;  ///< parameters at which it is linearised
  const model::Vehicle* vehicle_;
  Utime origin_;
  double max_gap_;
  std::vector<model::EffectColumns> wrenches_, momenta_;  // ring
  std::size_t next_{}, filled_{};
  model::EffectColumns filtered_;
  EffectSample last_;
  bool has_last_{false};
  std::vector<Eigen::VectorXd> past_;  // commands on a uniform grid, for delays
  Utime past_begin_{};
};

}  // namespace fathom::identification
