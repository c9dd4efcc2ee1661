#include "common/identification/mode_metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/motions.hpp"

namespace fathom::identification {

std::vector<ModeMetric> mode_metrics(const std::vector<model::BaseParameter>& parameters,
                                     const ParameterVector& variance, const ParameterVector& estimate,
                                     const ParameterVector& sigma) {
  std::array<ModeMetric, 6> modes;
  std::array<bool, 6> any{};
  ModeMetric total{.mode = "total"};
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const auto axis = static_cast<std::size_t>(model::axis(parameters[k]));
    const double size = std::abs(estimate(i));
    const double relative = size > 0.0 ? sigma(i) / size : 1e3;  // at zero nothing is known in proportion
    for (ModeMetric* mode : {&modes[axis], &total}) {
      mode->sum += variance(i);
      mode->scaled = std::max(mode->scaled, relative);
    }
    any[axis] = true;
  }
  std::vector<ModeMetric> all;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!any[axis]) continue;
    modes[axis].mode = kMotionNames[axis];
    all.push_back(modes[axis]);
  }
  all.push_back(total);
  return all;
}

}  // namespace fathom::identification
