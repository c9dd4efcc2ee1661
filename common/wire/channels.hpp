// Names of the channels. Their types, rates, speakers and hearers: docs/messages.md.
#pragma once

namespace fathom::wire {

inline constexpr char kAhrs[] = "AHRS";
inline constexpr char kCamera[] = "CAMERA";
inline constexpr char kCameraDebug[] = "CAMERA_DEBUG";
inline constexpr char kDvl[] = "DVL";
inline constexpr char kUsbl[] = "USBL";
inline constexpr char kDepth[] = "DEPTH";
inline constexpr char kRanges[] = "RANGES";
inline constexpr char kLoads[] = "LOADS";
inline constexpr char kSignal[] = "SIGNAL";
inline constexpr char kPoseCapture[] = "POSE_CAPTURE";
inline constexpr char kBattery[] = "BATTERY";
inline constexpr char kVehicle[] = "VEHICLE";
inline constexpr char kTagPose[] = "TAG_POSE";
inline constexpr char kOpticalFlow[] = "OPTICAL_FLOW";
inline constexpr char kLaserRange[] = "LASER_RANGE";
inline constexpr char kWrenchCommand[] = "WRENCH_COMMAND";
inline constexpr char kOperator[] = "OPERATOR";
inline constexpr char kAnswer[] = "ANSWER";
inline constexpr char kThrusters[] = "THRUSTERS";
inline constexpr char kState[] = "STATE";
inline constexpr char kSmoothed[] = "SMOOTHED";
inline constexpr char kModel[] = "MODEL";
inline constexpr char kResidual[] = "RESIDUAL";
inline constexpr char kEffects[] = "EFFECTS";
inline constexpr char kLearned[] = "LEARNED";
inline constexpr char kExcitation[] = "EXCITATION";
inline constexpr char kTruth[] = "TRUTH";
inline constexpr char kHealth[] = "HEALTH";
inline constexpr char kProcessInfo[] = "PROCESS_INFO";

}  // namespace fathom::wire
