#include "common/driver/lever_arm.hpp"

#include <cmath>

namespace fathom::driver {
namespace {

constexpr double kStale = 0.5;  // s

bool fresh(const std::optional<Ahrs>& heard, Utime now) {
  return heard && std::abs(seconds_between(heard->utime, now)) <= kStale;
}

}  // namespace

void LeverArm::hear(const Ahrs& ahrs) {
  if (ahrs.has_rates) rates_ = ahrs;
  if (ahrs.has_attitude) attitude_ = ahrs;
}

void LeverArm::remove(Dvl& sample) const {
  if (!needed() || !sample.valid) return;
  if (!fresh(rates_, sample.utime)) {
    sample.valid = false;
    sample.v_WB_B.setZero();
    return;
  }
  sample.v_WB_B -= rates_->w_WB_B.cross(p_BS_);
}

void LeverArm::remove(Depth& sample) const {
  const bool tilted = fresh(attitude_, sample.utime);
  sample.z -= tilted ? (attitude_->q_WB * p_BS_).z() : p_BS_.z();
}

}  // namespace fathom::driver
