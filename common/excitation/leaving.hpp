// When a mode may be left. A covariance never sees the residual, so its threshold alone would pass a wrong model
// (docs/decisions/012-leaving-a-mode.md): the residual and physics must agree.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/samples/estimates.hpp"

namespace fathom::model {
struct Vehicle;
}

namespace fathom::excitation {

/// One mode of the schedule: which axis is excited (0..5), -1 for all.
struct Mode {
  std::string name;
  int axis{-1};
  double threshold{};  ///< P* of the paper's eq. 1.15
};

struct LeavingSettings {
  double largest_ratio{1.5};   ///< mean square of the residual over that of the noise
  double largest_mean{4.0};    ///< mean of the residual in its own standard deviations
  double lightest_share{0.3};  ///< of the dry mass: the least that mass and added mass together can be
  double heaviest_share{6.0};
  double ordinary_speed{0.3};  ///< m/s or rad/s at which drag must brake
};

struct LeavingVerdict {
  double metric{-1.0};                      ///< -1: MODEL does not have it yet
  bool certain{false};                      ///< the metric is below the threshold
  std::vector<std::string> missing;         ///< each in a few words; empty: the mode may be left
  [[nodiscard]] std::string words() const;  ///< what is missing, in one line
};

/// Names of the parameters that belong to a mode: those of its axis, all for -1.
[[nodiscard]] std::vector<std::string> parameters_of(const Mode& mode, const model::Vehicle& vehicle);
[[nodiscard]] LeavingVerdict may_leave(const Mode& mode, const ModelEstimate& model, const model::Vehicle& vehicle,
                                       const LeavingSettings& settings);

}  // namespace fathom::excitation
