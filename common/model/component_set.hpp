// Forms of an effect that are sets of its components: bit i of the set stands for component i, 0 for none of them. One
// set can be asked for on a vehicle; the others are forms without a name there.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "common/model/effect.hpp"
#include "common/model/one_of_many.hpp"

namespace fathom::model {

constexpr int kSetsOfThree = 8;

[[nodiscard]] constexpr bool in_set(int set, std::size_t component) { return (set >> component & 1) != 0; }

/// The numbers before `first`, and those of the set's components that begin there.
[[nodiscard]] constexpr NumberSet numbers_of(int set, std::size_t first = 0) {
  NumberSet numbers;
  for (std::size_t i = 0; i < first; ++i) numbers.add(i);
  for (std::size_t i = 0; i < 3; ++i) {
    if (in_set(set, i)) numbers.add(first + i);
  }
  return numbers;
}

/// Their names: "x_G, y_G".
[[nodiscard]] inline std::string names_of(std::span<const EffectParameter> parameters, int set) {
  std::string names;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (in_set(set, i)) names += (names.empty() ? "" : ", ") + std::string{parameters[i].name};
  }
  return names;
}

/// One form per set of three components: F{set}, from none to all.
template <class F>
[[nodiscard]] Forms form_per_set() {
  Forms all;
  for (int set = 0; set < kSetsOfThree; ++set) all.push_back(std::make_unique<F>(set));
  return all;
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
