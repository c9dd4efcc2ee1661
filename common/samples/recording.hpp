// One run as recorded: every stream on its own clock, in the order of its time stamps.
#pragma once

#include <string>
#include <vector>

#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/sensors.hpp"
#include "common/samples/truth.hpp"
#include "common/samples/vision.hpp"

namespace fathom {

/// Streams of one run. An empty stream means: not recorded. Pictures stay in the log: they do not fit into memory.
struct Recording {
  std::string name;          ///< file name without folder and extension
  bool one_estimate{false};  ///< velocities in `dvl` come from the same estimate as `pose_capture`: they prove nothing
  bool pose_estimated{false};  ///< `pose_capture` is an estimate: its change is no measurement where one was made
  std::vector<PoseCapture> pose_capture;
  std::vector<Ahrs> ahrs;
  std::vector<Dvl> dvl;
  std::vector<Depth> depth;
  std::vector<Thrusters> thrusters;
  std::vector<Battery> battery;
  std::vector<StateEstimate> state;  ///< from an estimator, when the log holds it
  std::vector<SmoothedState> smoothed;
  std::vector<Usbl> usbl;
  std::vector<Ranges> ranges;
  std::vector<Loads> loads;
  std::vector<Signal> signals;  ///< all columns, in the order of time
  std::vector<TagPose> tag_pose;
  std::vector<OpticalFlow> optical_flow;
  std::vector<LaserRange> laser_range;
  std::vector<WrenchCommand> wrench_command;
  std::vector<Operator> operator_orders;
  std::vector<Answer> answers;
  std::vector<Excitation> excitation;
  std::vector<ModelEstimate> model;
  std::vector<Residual> residual;
  std::vector<EffectRanking> effects;
  std::vector<LearnedTold> learned;
  std::vector<Truth> truth;
  std::vector<Health> health;
  std::vector<ProcessInfo> process_info;
};

}  // namespace fathom
