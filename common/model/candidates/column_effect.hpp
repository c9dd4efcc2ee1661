// The effect of a candidate: a force that goes with measured columns. Made for the recordings at hand, for its prior is
// the size of what drives the vehicle there, and what goes with a column is told about the column's own mean.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/model/effect.hpp"
#include "common/samples/trial.hpp"

namespace fathom::model {

/// What shows such an effect best.
inline constexpr std::string_view kShowsColumn = "a recording in which the column changes while all else is as it was";

struct Candidates {
  std::vector<std::shared_ptr<const Effect>> effects;
  /// Of those that nothing can go with: effect and why.
  struct Idle {
    std::string name, reason;
  };
  std::vector<Idle> idle;
  [[nodiscard]] std::vector<const Effect*> pointers() const;
};

/// Of the vehicle's candidates, whose columns `trials` hold. InputError where runs have one in different units.
[[nodiscard]] Candidates candidates_of(const Vehicle& vehicle, std::span<const Trial> trials);

}  // namespace fathom::model
