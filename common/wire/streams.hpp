// The streams of a Recording with their channels: the one list that reader and writer share.
#pragma once

#include <algorithm>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/learned_t.hpp>
#include <fathom_lcm/loads_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/process_info_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/residual_t.hpp>
#include <fathom_lcm/signal_t.hpp>
#include <fathom_lcm/smoothed_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/truth_t.hpp>
#include <fathom_lcm/usbl_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <utility>

#include "common/samples/recording.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::wire {

/// Message type of a sample.
template <class Sample>
using MessageOf = decltype(encode(std::declval<const Sample&>()));

/// visit(channel, vector of samples) for every stream. At equal times a log holds them in this order: causes first.
template <class AnyRecording, class Visit>
void visit_streams(AnyRecording& recording, Visit&& visit) {
  visit(kProcessInfo, recording.process_info);
  visit(kOperator, recording.operator_orders);
  visit(kAnswer, recording.answers);
  visit(kExcitation, recording.excitation);
  visit(kWrenchCommand, recording.wrench_command);
  visit(kThrusters, recording.thrusters);
  visit(kBattery, recording.battery);
  visit(kLoads, recording.loads);
  visit(kSignal, recording.signals);
  visit(kAhrs, recording.ahrs);
  visit(kDvl, recording.dvl);
  visit(kDepth, recording.depth);
  visit(kUsbl, recording.usbl);
  visit(kRanges, recording.ranges);
  visit(kPoseCapture, recording.pose_capture);
  visit(kTagPose, recording.tag_pose);
  visit(kOpticalFlow, recording.optical_flow);
  visit(kLaserRange, recording.laser_range);
  visit(kTruth, recording.truth);
  visit(kState, recording.state);
  visit(kSmoothed, recording.smoothed);
  visit(kModel, recording.model);
  visit(kResidual, recording.residual);
  visit(kEffects, recording.effects);
  visit(kLearned, recording.learned);
  visit(kHealth, recording.health);
}

/// Each stream in the order of its time stamps; samples of equal ones as they came.
inline void put_in_order(Recording& recording) {
  visit_streams(recording, [](const char*, auto& samples) {
    const auto older = [](const auto& a, const auto& b) { return a.utime < b.utime; };
    if (!std::is_sorted(samples.begin(), samples.end(), older)) {
      std::stable_sort(samples.begin(), samples.end(), older);
    }
  });
}

}  // namespace fathom::wire
