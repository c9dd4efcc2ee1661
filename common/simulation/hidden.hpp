// Effects that a run hides in the truth: by name with numbers, or with sizes drawn from the effect's prior.
#pragma once

#include <string>
#include <vector>

#include "common/model/effect.hpp"
#include "common/model/site.hpp"

namespace fathom::simulation {

/// Where the vehicle starts and how long it will dive: what places and moments of an effect are drawn for.
struct Occasion {
  const model::Vehicle* vehicle{};
  const model::Site* site{};
  Eigen::Vector3d start{Eigen::Vector3d::Zero()};  ///< m
  double duration{};                               ///< s
  double righting{};                               ///< N m, the truth's |G_z|
  double voltage{};                                ///< V; 0: no battery
};

/// "NAME" or "NAME=key:value,key:value": parameters by their names in SI, and `variant:NAME`. What is not said is drawn
/// by `seed`: sizes 0.5 to 1.5 prior sigmas; places at the site (anchor, wall, bottom); moments in the middle half of
/// the run. InputError names what is not known and lists what is.
[[nodiscard]] model::ActiveEffect hidden_effect(const std::string& text, const Occasion& occasion, std::uint64_t seed);

}  // namespace fathom::simulation
