// Velocity and rates out of a pose: slopes of local polynomials over the stamps that there are, equal steps or not.
#pragma once

#include "common/estimation/timeline.hpp"

namespace fathom::estimation {

/// One of two sources of three components, with its white noise.
struct DerivativeSource {
  Series series;
  Eigen::Vector3d sigma{Eigen::Vector3d::Zero()};
  double bridged{};  ///< s between samples that a spline runs across, where that is more than a few steps
  [[nodiscard]] bool exists() const { return series.size() > 3; }
};

/// Body velocity and body rates from the pose, where all samples under the window are valid.
struct PoseDerivatives {
  DerivativeSource velocity, rates;
};

[[nodiscard]] PoseDerivatives differentiate(const PoseSeries& pose);

}  // namespace fathom::estimation
