// Forms of an effect that are sets of its components: bit i of the variant stands for component i, 0 for none of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "common/model/effect.hpp"

namespace fathom::model {

[[nodiscard]] constexpr bool in_set(int set, std::size_t component) { return (set >> component & 1) != 0; }

/// The forms of an effect of which one set can be asked for, under `name`. `none`: what the empty set is called, if it
/// is a form.
[[nodiscard]] inline std::vector<std::string> forms_of(int set, const std::string& name,
                                                       std::vector<std::string> none = {}) {
  if (set == 0) return none;
  none.resize(static_cast<std::size_t>(set), "-");
  none.push_back(name);
  return none;
}

/// The components of the set, from theta[first] on; zero the others.
[[nodiscard]] inline Eigen::Vector3d components(EffectTheta theta, int set, std::size_t first = 0) {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    if (in_set(set, i)) v[static_cast<Eigen::Index>(i)] = theta[first + i];
  }
  return v;
}

}  // namespace fathom::model
