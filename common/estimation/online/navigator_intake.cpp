// What is let in of the samples that arrive, what is refused and why, and what HEALTH says of it.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/estimation/online/navigator.hpp"

namespace fathom::estimation {
namespace {

constexpr int kAttitudePatience = 20;
constexpr std::size_t kMostWaiting = 1000;  // before the first attitude
constexpr double kLatest = 2.5;             // s later than stated: rather a clock that is wrong than a slow instrument
constexpr double kAhrsAway = 0.5;           // s without an attitude that can be used
constexpr double kLargestForce = 50.0;      // m/s^2; a vehicle under water is far below
constexpr double kLargestRate = 20.0;       // rad/s
constexpr double kAttitudeJump = 0.1;       // rad between what the gyro says and what the attitude says

std::size_t slot(Source source) { return static_cast<std::size_t>(source); }
constexpr std::array kNames{"AHRS", "POSE_CAPTURE", "TAG_POSE", "OPTICAL_FLOW", "LASER_RANGE", "DVL", "USBL", "DEPTH"};
const char* channel(Source source) { return kNames[slot(source)]; }

}  // namespace

const Navigator::Output& Navigator::step(const TagPose& sample) {
  const auto camera = places_.cameras.find(sample.camera);
  const auto tag = places_.tags.find(sample.tag);
  output_.clear();
  if (tag == places_.tags.end()) {
    ++other_["TAG_POSE of a tag that the site does not have"];
    return output_;
  }
  if (camera == places_.cameras.end()) {
    ++other_["TAG_POSE of a camera that the vehicle does not have"];
    return output_;
  }
  const CameraMount& mount = camera->second;
  return wait({.utime = sample.utime,
               .source = Source::kTagPose,
               .a = tag->second,
               .b = mount.p_BC + mount.R_BC * sample.p_CT,
               .camera = &mount});
}

const Navigator::Output& Navigator::step(const OpticalFlow& sample) {
  const auto camera = places_.cameras.find(sample.camera);
  output_.clear();
  if (camera == places_.cameras.end()) {
    ++other_["OPTICAL_FLOW of a camera that the vehicle does not have"];
    return output_;
  }
  return wait({.utime = sample.utime,
               .source = Source::kOpticalFlow,
               .a = sample.flow_C,
               .b = sample.covariance.diagonal(),
               .sigma = sample.sigma_across(),
               .camera = &camera->second});
}

const Navigator::Output& Navigator::step(const LaserRange& sample) {
  const auto camera = places_.cameras.find(sample.camera);
  output_.clear();
  if (camera == places_.cameras.end()) {
    ++other_["LASER_RANGE of a camera that the vehicle does not have"];
    return output_;
  }
  return wait({.utime = sample.utime,
               .source = Source::kLaserRange,
               .a = sample.p_CL,
               .sigma = sample.sigma_range,
               .camera = &camera->second});
}

const Navigator::Output& Navigator::step(const Dvl& sample) {
  output_.clear();
  if (!sample.valid || sample.held) {
    ++other_[sample.held ? "DVL held" : "DVL without lock"];
    return output_;
  }
  return wait({.utime = sample.utime, .source = Source::kDvl, .a = sample.v_WB_B});
}

const Navigator::Output& Navigator::step(const Usbl& sample) {
  output_.clear();
  if (!sample.valid) {
    ++other_["USBL not trusted by itself"];
    return output_;
  }
  return wait({.utime = sample.utime, .source = Source::kUsbl, .a = sample.p_WB, .b = sample.sigma});
}

const Navigator::Output& Navigator::step(const Depth& sample) {
  output_.clear();
  return wait({.utime = sample.utime, .source = Source::kDepth, .a = {0.0, 0.0, sample.z}});
}

const Navigator::Output& Navigator::wait(const Measurement& m) {
  const std::size_t i = slot(m.source);
  if (!aid(m.source).used) return output_;
  if (!m.a.allFinite() || !m.b.allFinite() || !std::isfinite(m.sigma)) {
    ++malformed_[i];
    return output_;
  }
  without_ahrs(m.source, m.utime);
  if (count_ > 0) {
    const Utime newest = this->newest().utime;
    const double age = seconds_between(m.utime, newest);
    if (without_ahrs_ <= kAhrsAway) clocks_.hear(i, m.utime, age, aid(m.source).delay, settings_.max_gap);
    if (m.utime < nodes_[first_].utime || age > aid(m.source).delay + kLatest) {
      ++late_[i];
      return output_;
    }
    if (age >= aid(m.source).delay) ++overdue_[i];
    // From the future: a clock that jumped, or no attitude comes. Nothing may wait for hours.
    if (seconds_between(newest, m.utime) > settings_.max_gap + 1.0) {
      if (without_ahrs_ > kAhrsAway) {
        ++other_[std::string{channel(m.source)} + " without AHRS"];
      } else {
        ++malformed_[i];
      }
      return output_;
    }
  }
  if (count_ == 0 && waiting_.size() >= kMostWaiting) waiting_.erase(waiting_.begin());
  const auto place =
      std::upper_bound(waiting_.begin(), waiting_.end(), m, [](const Measurement& a, const Measurement& b) {
        return a.utime != b.utime ? a.utime < b.utime : a.source < b.source;
      });
  waiting_.insert(place, m);
  return output_;
}

bool Navigator::usable(const Ahrs& sample) {
  if (!sample.has_attitude || !sample.has_rates || !sample.has_specific_force) {
    return refuse(sample, "without attitude, rates or specific force");
  }
  const double norm = sample.q_WB.norm();
  if (!sample.f_B.allFinite() || !sample.w_WB_B.allFinite() || !(std::abs(norm - 1.0) < 1e-2) ||
      sample.f_B.norm() > kLargestForce || sample.w_WB_B.norm() > kLargestRate) {
    return refuse(sample, "not plausible");
  }
  if (last_ahrs_) {
    const double dt = seconds_between(last_ahrs_->utime, sample.utime);
    if (dt <= 0.0) {
      return refuse(sample, "late");
    }
    const bool same = sample.f_B == last_ahrs_->f_B && sample.w_WB_B == last_ahrs_->w_WB_B &&
                      sample.q_WB.coeffs() == last_ahrs_->q_WB.coeffs();
    ahrs_repeated_ = same ? ahrs_repeated_ + 1 : 0;
    if (ahrs_repeated_ >= kRepeats) {
      return refuse(sample, "frozen");
    }
    if (dt <= settings_.max_gap) {
      const Eigen::Quaterniond expected =
          last_ahrs_->q_WB * quaternion_from_rotation_vector(0.5 * dt * (sample.w_WB_B + last_ahrs_->w_WB_B));
      if (expected.angularDistance(sample.q_WB) > kAttitudeJump && ++attitude_jumps_ < kAttitudePatience) {
        return refuse(sample, "jumped");
      }
    }
    attitude_jumps_ = 0;
  }
  first_without_ = {};
  without_ahrs_ = 0.0;
  refused_ahrs_ = nullptr;
  return true;
}

bool Navigator::refuse(const Ahrs& sample, const char* why) {
  ++other_[std::string{"AHRS "} + why];
  refused_ahrs_ = why;
  without_ahrs(Source::kAhrs, sample.utime);
  return false;
}

void Navigator::without_ahrs(Source source, Utime utime) {
  std::optional<Utime>& first = first_without_[slot(source)];
  if (!first) first = utime;
  without_ahrs_ = std::max(without_ahrs_, seconds_between(*first, utime));
}

std::map<std::string, std::int64_t> Navigator::rejected() const {
  std::map<std::string, std::int64_t> all = other_;
  const auto add = [&](Source source, const char* what, std::int64_t n) {
    if (n > 0) all[std::string{channel(source)} + " " + what] = n;
  };
  for (std::size_t i = 0; i < kSources; ++i) {
    const auto source = static_cast<Source>(i);
    add(source, "too late", late_[i]);
    add(source, "later than stated", overdue_[i]);
    add(source, "not plausible", malformed_[i]);
    if (count_ == 0) continue;
    const Track& track = newest().after.tracks[i];
    add(source, "gated", track.rejected[kGated]);
    add(source, "frozen", track.rejected[kFrozen]);
    add(source, "of a wall", track.rejected[kWall]);
  }
  return all;
}

std::string Navigator::remark() const { return clocks_.odd_one(kNames); }

std::string Navigator::complaint() const {
  if (count_ == 0) return "no AHRS sample with attitude, rates and specific force yet";
  if (ahrs_repeated_ >= kRepeats) return "AHRS is frozen";
  if (without_ahrs_ > kAhrsAway) {
    return refused_ahrs_ == nullptr
               ? "AHRS is silent or sends no numbers; without it there is no STATE"
               : std::string{"AHRS is refused: "} + refused_ahrs_ + "; without it there is no STATE";
  }
  // What comes late is made good later; not what comes hardly before it is too old.
  std::array<double, kSources> tolerated{};
  for (std::size_t i = slot(Source::kTagPose); i < kSources; ++i)
    tolerated[i] = 0.5 * aid(static_cast<Source>(i)).max_age;
  if (const std::string attitude = clocks_.attitude(); !attitude.empty()) return attitude;
  if (const std::string odd = clocks_.odd_one(kNames, tolerated); !odd.empty()) return odd;
  const auto& [utime, input, memory] = newest();
  if (!memory.started) return "no position yet: a tag of the site or an acoustic fix is needed";
  for (const Source source :
       {Source::kTagPose, Source::kOpticalFlow, Source::kLaserRange, Source::kDvl, Source::kUsbl, Source::kDepth}) {
    const AidSettings& s = aid(source);
    if (!s.used) continue;
    const Track& track = memory.tracks[slot(source)];
    const double age = track.last ? seconds_between(*track.last, utime) : HUGE_VAL;
    if (age <= s.max_age) continue;
    if (track.repeats()) return std::string{channel(source)} + " is frozen";
    if (const std::string off = clocks_.off(slot(source), channel(source)); !off.empty()) return off;
    if (track.walled) return std::string{channel(source)} + " looks at a wall";
    if (track.refused > 0) return std::string{channel(source)} + " does not fit the motion";
    return std::string{channel(source)} + " is silent";
  }
  return {};
}

}  // namespace fathom::estimation
