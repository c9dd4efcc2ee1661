// One run as recorded: every stream on its own clock, in the order of its time stamps.
#pragma once

#include <string>
#include <vector>

#include "common/samples/estimates.hpp"
#include "common/samples/sensors.hpp"

namespace fathom {

/// Streams of one run. An empty stream means: not recorded.
struct Recording {
  std::string name;  ///< file name without folder and extension
  std::vector<PoseCapture> pose_capture;
  std::vector<Ahrs> ahrs;
  std::vector<Dvl> dvl;
  std::vector<Depth> depth;
  std::vector<Thrusters> thrusters;
  std::vector<Battery> battery;
  std::vector<StateEstimate> state;  ///< from an estimator, when the log holds it
};

}  // namespace fathom
