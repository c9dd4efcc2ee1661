// Where on the vehicle a cable is made fast: at the origin, or at a place to be found. How high is sought where roll or
// pitch is simulated, or moves a cable that drags; a level vehicle otherwise tells an anchor that is as much too deep.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Of the last three numbers of an effect. Its forms are the sets of components that are asked for: bit i of the
/// variant is component i, variant 0 is the origin.
constexpr std::array kAttachment{EffectParameter{"attached_x", "m", 0.3, -3.0, 3.0},
                                 EffectParameter{"attached_y", "m", 0.3, -3.0, 3.0},
                                 EffectParameter{"attached_z", "m", 0.3, -3.0, 3.0}};

constexpr bool attachment_asked(int variant, std::size_t component) { return (variant >> component & 1) != 0; }

/// The origin, and the place of which all components are sought that turn the vehicle about a simulated axis; its
/// height also where it is `felt` otherwise.
[[nodiscard]] inline std::vector<std::string> attachment_forms(const Vehicle& vehicle, bool felt = false) {
  const auto& dof = vehicle.dof;
  const bool turns = dof[3] || dof[4] || dof[5];
  const std::array acts{dof[4] || dof[5], dof[3] || dof[5], dof[3] || dof[4] || (turns && felt)};
  std::size_t form = 0;
  for (std::size_t i = 0; i < acts.size(); ++i) form |= acts[i] ? std::size_t{1} << i : 0;
  std::vector<std::string> names{""};
  if (form == 0) return names;
  names.resize(form, "-");
  names.emplace_back("made fast off the origin");
  return names;
}

/// m, in B. `first`: which of the effect's numbers is attached_x.
[[nodiscard]] inline Eigen::Vector3d attachment(EffectTheta theta, int variant, std::size_t first) {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    if (attachment_asked(variant, i)) p[static_cast<Eigen::Index>(i)] = theta[first + i];
  }
  return p;
}

}  // namespace fathom::model
