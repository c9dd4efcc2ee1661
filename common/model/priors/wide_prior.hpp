// What is assumed about a base parameter when the vehicle file is silent: all that act, each within wide bounds.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/model/parameters.hpp"

namespace fathom::model {

struct Prior;
struct Vehicle;

/// All base parameters that act on the enabled degrees of freedom (X Y Z K M N).
[[nodiscard]] std::vector<std::string> default_parameters(const std::array<bool, 6>& dof);
/// A wide prior scaled from mass and size. Needs vehicle.mass and vehicle.water_density.
[[nodiscard]] Prior wide_prior(BaseParameter parameter, const Vehicle& vehicle);

}  // namespace fathom::model
