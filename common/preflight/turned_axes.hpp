// Whether the whole vehicle seems wired crosswise because the motion is told along other axes than the file's: left and
// up in place of right and down, say. A half turn of the axes moves every thruster at once.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "common/preflight/thrust_evidence.hpp"

namespace fathom::preflight {

/// A half turn of the body's axes.
struct TurnedAxes {
  std::array<int, 6> sign;  ///< of X Y Z K M N
  const char* words;        ///< what the data seems to have
  double cost{};            ///< minus log likelihood
};

/// The half turn under which acceleration follows thrust best. `allocation`: of the inputs, as the file has it.
[[nodiscard]] TurnedAxes likeliest_turn(const ThrustEvidence& evidence,
                                        const Eigen::Matrix<double, 6, Eigen::Dynamic>& allocation);

/// The wrench of each input along the turned axes.
[[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> turned(
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& allocation, const TurnedAxes& axes);

}  // namespace fathom::preflight
