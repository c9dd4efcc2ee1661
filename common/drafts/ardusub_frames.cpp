#include "common/drafts/ardusub_frames.hpp"

#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"

namespace fathom::drafts {
namespace {

// libraries/AP_Motors/AP_Motors6DOF.cpp of ArduPilot: facts of its frames, motor outputs 1 and on.
constexpr std::array<FrameMotor, 6> kBlueRov1{{{0, 0, -1, 0, 1, 0},
                                               {0, 0, 1, 0, 1, 0},
                                               {-0.5, 0.5, 0, 0.45, 0, 0},
                                               {0.5, 0.5, 0, 0.45, 0, 0},
                                               {0, -1, 0, 1, 0, 0},
                                               {-0.25, 0, 0, 0, 0, 1}}};
constexpr std::array<FrameMotor, 6> kVectored{{{0, 0, 1, 0, -1, 1},
                                               {0, 0, -1, 0, -1, -1},
                                               {0, 0, -1, 0, 1, 1},
                                               {0, 0, 1, 0, 1, -1},
                                               {1, 0, 0, -1, 0, 0},
                                               {-1, 0, 0, -1, 0, 0}}};
constexpr std::array<FrameMotor, 8> kVectored6Dof{{{0, 0, 1, 0, -1, 1},
                                                   {0, 0, -1, 0, -1, -1},
                                                   {0, 0, -1, 0, 1, 1},
                                                   {0, 0, 1, 0, 1, -1},
                                                   {1, -1, 0, -1, 0, 0},
                                                   {-1, -1, 0, -1, 0, 0},
                                                   {1, 1, 0, -1, 0, 0},
                                                   {-1, 1, 0, -1, 0, 0}}};
constexpr std::array<FrameMotor, 8> kVectored6Dof90{{{1, 1, 0, 1, 0, 0},
                                                     {0, 0, 1, 0, 1, 0},
                                                     {1, -1, 0, 1, 0, 0},
                                                     {0, 0, 0, 0, 0, 1},
                                                     {0, 0, 0, 0, 0, 1},
                                                     {-1, 1, 0, 1, 0, 0},
                                                     {0, 0, -1, 0, 1, 0},
                                                     {-1, -1, 0, 1, 0, 0}}};
constexpr std::array<FrameMotor, 5> kSimpleRov{
    {{0, 0, -1, 0, 1, 0}, {0, 0, 1, 0, 1, 0}, {0, 0, 0, -1, 0, 0}, {0, 0, 0, -1, 0, 0}, {0, 0, 0, 0, 0, 1}}};
constexpr std::array<ArdusubFrame, 7> kFrames{{{"bluerov1", kBlueRov1},
                                               {"vectored", kVectored},
                                               {"vectored-6dof", kVectored6Dof},
                                               {"vectored-6dof-90deg", kVectored6Dof90},
                                               {"simplerov-3", std::span{kSimpleRov}.first(3)},
                                               {"simplerov-4", std::span{kSimpleRov}.first(4)},
                                               {"simplerov-5", kSimpleRov}}};

// m: a lever that is measured as zero decides nothing.
constexpr double kNoLever = 0.005;

// ArduSub's throttle is upward.
Eigen::Vector3d axis_of(const FrameMotor& motor) {
  return Eigen::Vector3d{motor.forward, motor.lateral, -motor.throttle}.normalized();
}

// Where the signs of its turning factors put a motor: the moment p x f has them.
std::string where(const FrameMotor& motor) {
  const Eigen::Vector3d f = axis_of(motor);
  std::string text;
  const auto say = [&](double sign, const char* positive, const char* negative) {
    if (sign != 0.0) text += (text.empty() ? "" : ", ") + std::string{sign > 0.0 ? positive : negative};
  };
  const double x = f.z() != 0.0 ? -motor.pitch * f.z() : motor.yaw * f.y();
  const double y = f.z() != 0.0 ? motor.roll * f.z() : -motor.yaw * f.x();
  const double z = f.z() == 0.0 && motor.roll != 0.0 ? -motor.roll * f.y() : 0.0;
  say(x, "ahead", "astern");
  say(y, "to starboard", "to port");
  say(z, "below", "above");
  return text;
}

void check_turns(const FrameMotor& motor, int number, const Eigen::Vector3d& p_BJ, const std::string& frame) {
  const Eigen::Vector3d moment = p_BJ.cross(axis_of(motor));
  constexpr std::array kTurns{"roll", "pitch", "yaw"};
  const std::array factors{motor.roll, motor.pitch, motor.yaw};
  for (std::size_t i = 0; i < 3; ++i) {
    const double lever = moment[static_cast<Eigen::Index>(i)];
    if (factors[i] == 0.0 || std::abs(lever) < kNoLever || lever * factors[i] > 0.0) continue;
    throw InputError("--place " + std::to_string(number) + ": there, motor " + std::to_string(number) + " of frame " +
                     frame + " would " + kTurns[i] + " the vehicle the other way than ArduSub's frame says; it is " +
                     where(motor) + " (forward, right, down of the origin)");
  }
}

}  // namespace

std::span<const ArdusubFrame> ardusub_frames() { return kFrames; }

const ArdusubFrame& ardusub_frame(const std::string& name) {
  std::string all, near;
  for (const ArdusubFrame& each : kFrames) {
    if (each.name == name) return each;
    all += (all.empty() ? "" : ", ") + std::string{each.name};
    if (near.empty() && looks_like(name, std::string{each.name}))
      near = " (did you mean " + std::string{each.name} + "?)";
  }
  throw InputError("ArduSub has no frame " + name + near + "; there are: " + all);
}

Draft draft_of_frame(const std::string& name, const std::map<int, Eigen::Vector3d>& places) {
  const ArdusubFrame* frame = &ardusub_frame(name);
  for (const auto& [number, place] : places) {
    if (number < 1 || static_cast<std::size_t>(number) > frame->motors.size()) {
      throw InputError("--place " + std::to_string(number) + ": frame " + name + " has motors 1 to " +
                       std::to_string(frame->motors.size()));
    }
  }
  Draft draft{.name = "ArduSub " + name,
              .remarks = {"Directions and order of the motors by ArduSub's frame " + name +
                              " (FRAME_CONFIG), whose outputs they are;",
                          "a motor whose MOT_n_DIRECTION is -1 has its axis turned round. Forward-right-down about the "
                          "centre of mass."}};
  int number = 0;
  bool measured = true;
  for (const FrameMotor& motor : frame->motors) {
    ++number;
    const auto place = places.find(number);
    const bool known = place != places.end();
    if (known) check_turns(motor, number, place->second, name);
    measured = measured && known;
    draft.thrusters.push_back({.name = "motor_" + std::to_string(number),
                               .p_BJ = known ? std::optional{place->second} : std::nullopt,
                               .axis_B = axis_of(motor),
                               .note = where(motor)});
  }
  if (!measured)
    draft.remarks.emplace_back(
        "ArduSub does not know where its motors sit: measure what says MEASURE, forward, right, down in m.");
  draft.tail =
      "\n# thrust_curve:  # pulse widths to N: of your thrusters; that of the T200 is in 'fathom vehicle "
      "bluerov2_heavy'\n"
      "# The axes are as the factors for ahead, starboard and up say; where yours are mounted otherwise, measure them "
      "too.\n";
  return draft;
}

}  // namespace fathom::drafts
