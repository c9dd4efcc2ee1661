// What propellers do along their own lines by their own force: the directions and columns of such laws.
#pragma once

#include <string>
#include <vector>

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// What propellers do along their lines, by their own force: one law for all where all actuators are propellers, else
/// one for each of them.
struct ThrusterLaw {
  std::string words;                      ///< "all thrusters", "thruster 2"
  int axis{};                             ///< Feature::axis
  int index{};                            ///< of its factors
  std::vector<likelihood::Factor> knots;  ///< hats over the force's size, of which any curve can be made
};
[[nodiscard]] std::vector<ThrusterLaw> thruster_laws(const likelihood::Problem& problem, const Seen& seen,
                                                     const model::Scene& scene);

}  // namespace fathom::inference
