// Which numbers of a model are free, and how they become one scaled vector for a solver and back.
#pragma once

#include <string>
#include <vector>

#include "common/model/dynamics.hpp"

namespace fathom::identification {

/// One free number of a model.
struct FreeParameter {
  int base{-1};        ///< index into BaseTheta, or -1 for an effect's number
  int effect{-1};      ///< index into Model::effects, or -1
  int component{};     ///< index into that effect's theta
  std::string name{};  ///< "X_u", or "thruster_lag.time_constant"
  std::string unit{};
  double scale{1.0};  ///< x = value / scale
  double prior_mean{};
  double prior_sigma{};
  double low{};  ///< physical bounds
  double high{};
  double form_sigma{};   ///< what an effect's assumed form leaves open, not seen by the fit
  bool after_command{};  ///< EffectParameter::after_command
  bool sought{true};     ///< false: keeps its value (Effect::takes_part)

  /// Whether a scaled value lies on a bound, to within rounding.
  [[nodiscard]] bool at_low(double x) const { return x * scale <= low + kBoundMargin * scale; }
  [[nodiscard]] bool at_high(double x) const { return x * scale >= high - kBoundMargin * scale; }
  [[nodiscard]] bool at_bound(double x) const { return at_low(x) || at_high(x); }

  static constexpr double kBoundMargin = 1e-9;  // of the scale
};

class ParameterMap {
 public:
  /// Base parameters that the vehicle enables, then every number of every effect. Scales come from the model's values.
  explicit ParameterMap(const model::Model& model);

  [[nodiscard]] std::size_t size() const { return free_.size(); }
  [[nodiscard]] const FreeParameter& operator[](std::size_t i) const { return free_[i]; }
  [[nodiscard]] Eigen::VectorXd pack(const model::Model& model) const;  ///< scaled, n
  void unpack(const Eigen::Ref<const Eigen::VectorXd>& x, model::Model& model) const;

 private:
  std::vector<FreeParameter> free_;
};

}  // namespace fathom::identification
