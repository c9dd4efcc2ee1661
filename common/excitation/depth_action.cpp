#include "common/excitation/depth_action.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::excitation {
namespace {

constexpr double kKnown = 0.5;    // m, std of z with which a depth can be held
constexpr double kUpright = 0.5;  // cosine of the tilt: beyond 60 degrees the vertical thrusters are none

bool depth_known(const StateEstimate& state) {
  return std::isfinite(state.p_WB.z()) && (state.valid || (state.sigma[2] > 0.0 && state.sigma[2] <= kKnown));
}

}  // namespace

void DepthAction::begin(const StateEstimate& state) {
  text_.clear();
  begun_.reset();
  if (after_.action == model::AfterAbort::Action::kZero) return;
  begun_ = state.utime;
  aimed_ = false;
  text_ = name(after_.action) + std::string{", at most "} + std::to_string(std::lround(after_.duration)) + " s";
}

Vector6d DepthAction::step(const StateEstimate& state, Hold& hold, double dt) {
  if (!begun_) return Vector6d::Zero();
  const double since = seconds_between(*begun_, state.utime);
  if (since > after_.duration) {
    begun_.reset();
    text_ = "zero thrust: " + std::to_string(std::lround(after_.duration)) + " s of 'after_abort' are over";
    return Vector6d::Zero();
  }
  const bool surfaces = after_.action == model::AfterAbort::Action::kSurface;
  text_ = name(after_.action) + std::string{", at most "} + std::to_string(std::lround(after_.duration)) + " s";
  const double upright = (state.q_WB * Eigen::Vector3d::UnitZ()).z();
  if (!(upright > kUpright)) {
    text_ += "; no thrust: it lies on its side";
    return Vector6d::Zero();
  }
  Vector6d tau = Vector6d::Zero();
  if (depth_known(state)) {
    if (!aimed_) aim_ = state.p_WB.z();
    aimed_ = true;
    if (surfaces) aim_ += std::clamp(surface_ - aim_, -after_.speed * dt, after_.speed * dt);
    const Place place{{state.p_WB.x(), state.p_WB.y(), aim_}, 0.0};
    tau[2] = hold.step(state, 0.0, place, {false, false, true, false, false, false}, dt)[2];
  } else {
    aimed_ = false;  // where it is back it goes on from there
    tau[2] = (hold.trim().z() - (surfaces ? after_.blind : 0.0)) / upright;
    text_ +=
        "; the depth is not known: " + std::string{surfaces && after_.blind > 0.0 ? "pushes upward" : "trim alone"};
  }
  tau[2] = std::clamp(tau[2], -after_.largest, after_.largest);
  return tau;
}

}  // namespace fathom::excitation
