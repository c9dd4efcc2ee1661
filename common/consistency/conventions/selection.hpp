// Which reading of a recording is the likeliest: one cause before two, named conventions before turns, turns before
// reflections, and nothing without significance.
#pragma once

#include <string>
#include <vector>

#include "common/consistency/conventions/evidence.hpp"

namespace fathom::consistency {

/// When a reading other than "as read" is believed.
struct SelectionThresholds {
  double gain{6.0};      ///< nats over the prior's penalty: odds of 400 to 1
  double z{4.0};         ///< of Vuong's test: one false step in 30,000
  double halves{0.5};    ///< of the unexplained variance of a relation that must go: smaller faults have other forms
  double tied{3.0};      ///< z below which two readings cannot be told apart
  double well{0.1};      ///< unexplained fraction above which two causes at once are tried
  double heading{0.17};  ///< rad: smaller turns of the heading are measured with the other small angles
  int causes{3};         ///< at most
};

struct Cause {
  const Hypothesis* hypothesis{};
  double gain{};  ///< nats against the reading without it
  double z{};
  double heading{};                                  ///< rad
  std::array<double, kRelations> before{}, after{};  ///< unexplained fractions
  std::array<bool, kRelations> seen{};
  std::vector<const Hypothesis*> instead;  ///< what these data cannot distinguish from it
};

struct Selection {
  Reading reading;
  std::vector<Cause> causes;
};

[[nodiscard]] Selection select_reading(const Evidence& evidence);

}  // namespace fathom::consistency
