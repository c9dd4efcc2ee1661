// The parameters of the base model: names, units, and what is assumed about them when the vehicle file is silent.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::model {

struct Prior;
struct Vehicle;

/// Which physics a base parameter belongs to, and so which sign it must have.
enum class ParameterKind { kInertia, kLinearDrag, kQuadraticDrag, kWeight, kMoment };

struct BaseParameter {
  std::string_view name;
  std::string_view unit;
  ParameterKind kind{};
  int axis{};  ///< 0..5 = X Y Z K M N; for G_x G_y G_z the index 0..2 of the component
};

/// Every base parameter there is, in the order of docs/configuration.md.
[[nodiscard]] const std::array<BaseParameter, 22>& base_parameters();
/// The one called `name`; nullptr when there is none.
[[nodiscard]] const BaseParameter* find_base_parameter(std::string_view name);
/// All that act on the enabled degrees of freedom.
[[nodiscard]] std::vector<std::string> default_parameters(const std::array<bool, 6>& dof);
/// A wide prior scaled from mass and size. Needs vehicle.mass and vehicle.water_density.
[[nodiscard]] Prior wide_prior(const BaseParameter& parameter, const Vehicle& vehicle);

}  // namespace fathom::model
