#include "common/excitation/hold.hpp"

#include <algorithm>

namespace fathom::excitation {
namespace {

constexpr double kLargestError = 0.5;      // m: farther away it goes there at a steady pace
constexpr double kLargestTurnError = 0.8;  // rad
constexpr double kTrimShare = 0.5;         // of the largest thrust: what trim may take

}  // namespace

Vector6d Hold::step(const StateEstimate& state, double turned, const Place& place, const std::array<bool, 6>& held,
                    double dt) {
  const Eigen::Matrix3d R_WB = state.q_WB.toRotationMatrix();
  const double w = settings_.bandwidth;
  const double spring = settings_.mass * w * w;
  const double damper = 2.0 * settings_.damping * settings_.mass * w;
  Eigen::Vector3d error_W = place.p_WB - state.p_WB;
  if (error_W.norm() > kLargestError) error_W *= kLargestError / error_W.norm();
  const Eigen::Vector3d error_B = R_WB.transpose() * error_W;
  Eigen::Vector3d on = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) on[i] = held[static_cast<std::size_t>(i)] ? 1.0 : 0.0;
  // Weight and buoyancy act along the vertical alone: the rest is drag of the tether or a current, and moves.
  const double vertical = R_WB.row(2).cwiseAbs2().dot(on);
  if (dt > 0.0 && vertical > 0.5) {
    const double bound = kTrimShare * largest_[2];
    trim_W_.z() += spring * error_W.z() * dt / settings_.trim_time;
    trim_W_.z() = std::clamp(trim_W_.z(), -bound, bound);
  }
  Vector6d tau = Vector6d::Zero();
  tau.head<3>() = on.cwiseProduct(spring * error_B - damper * state.nu.head<3>()) + R_WB.transpose() * trim_W_;
  if (held[5]) {
    const double error = std::clamp(place.turned - turned, -kLargestTurnError, kLargestTurnError);
    tau[5] = settings_.inertia * (4.0 * w * w * error - 4.0 * settings_.damping * w * state.nu[5]);
  }
  return tau.cwiseMax(-largest_).cwiseMin(largest_);
}

}  // namespace fathom::excitation
