#include "common/driver/lever_arm.hpp"

#include <cmath>
#include <limits>

namespace fathom::driver {
namespace {

constexpr double kStale = 0.5;  // s

}  // namespace

void LeverArm::hear(const Ahrs& ahrs) { heard_[count_++ % kKept] = ahrs; }

const Ahrs* LeverArm::nearest(Utime utime, bool Ahrs::*has) const {
  const Ahrs* found = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Ahrs& each : heard_) {
    const double apart = std::abs(seconds_between(each.utime, utime));
    if (each.*has && apart <= kStale && apart < least) {
      least = apart;
      found = &each;
    }
  }
  return found;
}

void LeverArm::remove(Dvl& sample) const {
  if (!needed() || !sample.valid) return;
  const Ahrs* rates = nearest(sample.utime, &Ahrs::has_rates);
  if (rates == nullptr) {
    sample.valid = false;
    sample.v_WB_B.setZero();
    return;
  }
  sample.v_WB_B -= rates->w_WB_B.cross(p_BS_);
}

void LeverArm::remove(Depth& sample) const {
  if (!needed()) return;
  const Ahrs* tilted = nearest(sample.utime, &Ahrs::has_attitude);
  sample.z -= tilted != nullptr ? (tilted->q_WB * p_BS_).z() : p_BS_.z();
}

void LeverArm::remove(Usbl& sample) const {
  if (!needed()) return;
  const Ahrs* attitude = nearest(sample.utime, &Ahrs::has_attitude);
  if (attitude == nullptr) {
    sample.valid = false;
    return;
  }
  sample.p_WB -= attitude->q_WB * p_BS_;
}

}  // namespace fathom::driver
