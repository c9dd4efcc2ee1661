// Where on the vehicle a cable or another part is made fast: at the origin, or at a place to be found. How high is
// sought where roll or pitch is simulated, or moves a cable that drags; a level vehicle otherwise tells an anchor that
// is as much too deep.
#pragma once

#include <array>

#include "common/model/component_set.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Of the last three numbers of an effect, whose forms are the sets of components that are asked for; none: the origin.
constexpr std::array kAttachment{EffectParameter{"attached_x", "m", 0.3, -3.0, 3.0},
                                 EffectParameter{"attached_y", "m", 0.3, -3.0, 3.0},
                                 EffectParameter{"attached_z", "m", 0.3, -3.0, 3.0}};

/// Whether it rolls or pitches at all, measured if not simulated: a high place then moves.
[[nodiscard]] inline bool sways(const Scene& scene) {
  constexpr double kSwaying = 0.01;  // rad/s
  return scene.nu_rms.segment<2>(3).norm() > kSwaying;
}

/// The components of the place that turn the vehicle about a simulated axis; its height also where it is `felt`
/// otherwise.
[[nodiscard]] inline int attachment_set(const Vehicle& vehicle, bool felt = false) {
  const auto& dof = vehicle.dof;
  const bool turns = dof[3] || dof[4] || dof[5];
  const std::array acts{dof[4] || dof[5], dof[3] || dof[5], dof[3] || dof[4] || (turns && felt)};
  int set = 0;
  for (std::size_t i = 0; i < acts.size(); ++i) set |= acts[i] ? 1 << i : 0;
  return set;
}

/// What a form is called that seeks the components `set`: the origin, or all that `asked` names.
[[nodiscard]] inline FormName attachment_name(int set, int asked) {
  return set == 0 ? FormName{""} : when(set == asked, "made fast off the origin");
}

}  // namespace fathom::model
