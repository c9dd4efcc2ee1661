#include "common/driver/lever_arm.hpp"

#include <cmath>

namespace fathom::driver {
namespace {

constexpr double kStale = 0.5;  // s

}  // namespace

void LeverArm::hear(const Ahrs& ahrs) { heard_[count_++ % kKept] = ahrs; }

std::optional<Ahrs> LeverArm::at(Utime utime, bool Ahrs::*has) const {
  const Ahrs* before = nullptr;
  const Ahrs* after = nullptr;
  for (const Ahrs& each : heard_) {
    if (!(each.*has) || std::abs(seconds_between(each.utime, utime)) > kStale) continue;
    if (each.utime <= utime && (before == nullptr || each.utime > before->utime)) before = &each;
    if (each.utime >= utime && (after == nullptr || each.utime < after->utime)) after = &each;
  }
  if (before == nullptr && after == nullptr) return {};
  if (before == nullptr || after == nullptr || before->utime == after->utime)
    return before != nullptr ? *before : *after;
  const double share = seconds_between(before->utime, utime) / seconds_between(before->utime, after->utime);
  Ahrs between = *before;
  between.utime = utime;
  between.w_WB_B += share * (after->w_WB_B - before->w_WB_B);
  between.q_WB = before->q_WB.slerp(share, after->q_WB);
  return between;
}

void LeverArm::remove(Dvl& sample) const {
  if (!needed() || !sample.valid) return;
  const std::optional<Ahrs> rates = at(sample.utime, &Ahrs::has_rates);
  if (!rates) {
    sample.valid = false;
    sample.v_WB_B.setZero();
    return;
  }
  sample.v_WB_B -= rates->w_WB_B.cross(p_BS_);
}

void LeverArm::remove(Depth& sample) const {
  if (!needed()) return;
  const std::optional<Ahrs> tilted = at(sample.utime, &Ahrs::has_attitude);
  sample.z -= tilted ? (tilted->q_WB * p_BS_).z() : p_BS_.z();
}

void LeverArm::remove(Usbl& sample) const {
  if (!needed()) return;
  const std::optional<Ahrs> attitude = at(sample.utime, &Ahrs::has_attitude);
  if (!attitude) {
    sample.valid = false;
    return;
  }
  sample.p_WB -= attitude->q_WB * p_BS_;
}

}  // namespace fathom::driver
