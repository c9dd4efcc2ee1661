#include "common/devices/velocity/cerulean.hpp"

#include <algorithm>

namespace fathom::devices {
namespace {

constexpr std::size_t kShort = 10, kLong = 14;  // words of $DVPDL, $DVPDX
constexpr double kMicrosecond = 1e-6;           // s
// s: the log tells 5 to 20 times a second. A mean over much more is no velocity of a moment, one over less has no
// digits.
constexpr double kLeastInterval = 0.005, kMostInterval = 1.0;
constexpr double kMostSpeed = 30.0;  // m/s: no log measures more

}  // namespace

Cerulean::Cerulean(const Settings& settings) : NmeaParser{settings.checksum_required}, R_BS_{settings.R_BS} {}

void Cerulean::sentence(const Words& words, Frame& frame) {
  time_us_ = interval_us_ = dx_m_ = dy_m_ = dz_m_ = confidence_ = standoff_m_ = std::nullopt;
  const bool longer = words[0] == "DVPDX";
  if (words[0].size() == 5 && words[0].starts_with("DV") && !longer && words[0] != "DVPDL") frame.lacks = {};
  if (!longer && words[0] != "DVPDL") return;
  frame.lacks = "a field is missing";
  if (words.size() != (longer ? kLong : kShort)) return;
  time_us_ = words.number_at(1);
  interval_us_ = words.number_at(2);
  dx_m_ = words.number_at(6);
  dy_m_ = words.number_at(7);
  dz_m_ = words.number_at(8);
  confidence_ = words.number_at(9);
  if (longer) standoff_m_ = words.number_at(13);
  if (!time_us_ || !interval_us_ || !confidence_) return;
  const double interval = kMicrosecond * *interval_us_;
  frame.device_time = kMicrosecond * *time_us_ - 0.5 * interval;
  const bool trusted = *confidence_ > 0.0 && *confidence_ <= 100.0;
  const bool moment = interval >= kLeastInterval && interval <= kMostInterval;
  sample_ = Dvl{.altitude = trusted ? std::max(0.0, standoff_m_.value_or(0.0)) : 0.0,
                .valid = trusted && moment && dx_m_ && dy_m_ && dz_m_};
  if (sample_.valid) {
    const Eigen::Vector3d v_S = Eigen::Vector3d{*dx_m_, *dy_m_, *dz_m_} / interval;
    sample_.valid = v_S.cwiseAbs().maxCoeff() < kMostSpeed;
    if (sample_.valid) sample_.v_WB_B = R_BS_ * v_S;
  }
  frame.sample = &sample_;
}

void Cerulean::describe_values(Fields& fields) const {
  fields.add("time_us", time_us_);
  fields.add("interval_us", interval_us_);
  fields.add("dx_m", dx_m_);
  fields.add("dy_m", dy_m_);
  fields.add("dz_m", dz_m_);
  fields.add("confidence", confidence_);
  fields.add("standoff_m", standoff_m_);
}

}  // namespace fathom::devices
