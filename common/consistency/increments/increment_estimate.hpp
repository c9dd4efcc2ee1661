// One number read from an increment fit, and how sure it is: by what it does when blocks of data are left out, and by
// the misfit of all windows.
#pragma once

#include <functional>

#include "common/consistency/increments/increments.hpp"
#include "common/consistency/pairs/shared_value.hpp"

namespace fathom::consistency {

struct Uncertainty {
  double sigma{};   ///< by the misfit of all windows
  double blocks{};  ///< how many, as if of equal weight, tell of it
};
/// Of a function of theta that has this gradient. A manoeuvre that shows it once lies in one block or two, and these
/// few know little of their own scatter.
[[nodiscard]] Uncertainty uncertainty(const IncrementFit& fit, const Eigen::VectorXd& gradient);
[[nodiscard]] Uncertainty delay_uncertainty(const IncrementFit& fit);

/// `read` is a smooth function of theta. `bracket`: the sensor's own noise pulls the number toward zero.
[[nodiscard]] Estimate estimate(const IncrementFit& fit, const std::function<double(const Eigen::VectorXd&)>& read,
                                bool bracket);
[[nodiscard]] Estimate estimate_delay(const IncrementFit& fit);

}  // namespace fathom::consistency
