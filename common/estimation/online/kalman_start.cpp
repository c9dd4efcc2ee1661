#include "common/estimation/online/kalman_start.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/factors.hpp"

namespace fathom::estimation {
namespace {

namespace at = model::at;

constexpr double kPatience = 5.0;     // s after which a position that nothing measures is called zero
constexpr double kTolerance = 1.0;    // m by which ranges may contradict each other at the start
constexpr double kSwimRoll = 0.05;    // rad, spread of a vertical that the motion has disturbed
constexpr double kGravityBand = 0.2;  // share of g by which a resting accelerometer may be off

}  // namespace

std::optional<Eigen::Vector3d> locate(const std::vector<Transponder>& transponders, const std::vector<double>& ranges,
                                      std::optional<double> depth, double tolerance) {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  int heard = 0;
  for (std::size_t i = 0; i < std::min(transponders.size(), ranges.size()); ++i) {
    if (ranges[i] <= 0.0 || !transponders[i].used) continue;
    p += transponders[i].p_WT;
    ++heard;
  }
  if (heard < 3) return std::nullopt;
  p /= heard;
  p.z() = depth.value_or(p.z() - 1.0);  // the vehicle is above the seabed
  double worst = 0.0;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::Matrix3d H = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    worst = 0.0;
    for (std::size_t i = 0; i < std::min(transponders.size(), ranges.size()); ++i) {
      if (ranges[i] <= 0.0 || !transponders[i].used) continue;
      const Eigen::Vector3d apart = p - transponders[i].p_WT;
      const double range = std::max(apart.norm(), 1e-3);
      H += apart * apart.transpose() / (range * range);
      g += apart / range * (ranges[i] - range);
      worst = std::max(worst, std::abs(ranges[i] - range));
    }
    if (depth) {
      H(2, 2) += 1.0;
      g.z() += *depth - p.z();
    }
    const Eigen::Vector3d step = solve_symmetric(H, g);
    p += step;
    if (step.norm() < 1e-6) break;
  }
  if (!p.allFinite() || worst > tolerance) return std::nullopt;
  return p;
}

Verdict agree(const std::vector<Transponder>& transponders, std::vector<double>& ranges, std::optional<double> depth,
              double tolerance) {
  std::size_t heard = 0;
  for (std::size_t i = 0; i < std::min(transponders.size(), ranges.size()); ++i) {
    heard += ranges[i] > 0.0 && transponders[i].used ? 1 : 0;
  }
  const std::size_t redundant = depth ? 3 : 4;  // fewer ranges fit a place whatever they say
  if (heard < redundant || locate(transponders, ranges, depth, tolerance)) return {};
  for (std::size_t i = 0; i < std::min(transponders.size(), ranges.size()); ++i) {
    if (ranges[i] <= 0.0 || !transponders[i].used) continue;
    const double kept = ranges[i];
    ranges[i] = 0.0;
    const bool agreed = locate(transponders, ranges, depth, tolerance).has_value();
    ranges[i] = kept;
    if (agreed) return {Agreement::kAllButOne, i};
  }
  return {Agreement::kNone, 0};
}

void StartFinder::hear(Utime utime, const SampleView& sample) {
  if (!first_) first_ = utime;
  elapsed_ = seconds_between(*first_, utime);
  std::visit([this](const auto* one) { use(*one); }, sample);
}

void StartFinder::use(const Ahrs& sample) {
  if (sample.has_attitude && settings_->attitude == AttitudeUse::kEverything) attitude_ = sample.q_WB;
  if (sample.has_attitude && settings_->attitude == AttitudeUse::kHeading) {
    heading_ = euler_from_rotation(sample.q_WB.toRotationMatrix()).z() + settings_->declination;
  }
  const Eigen::Vector3d f = settings_->R_BI * sample.f_B;
  if (sample.has_specific_force && std::abs(f.norm() / settings_->gravity - 1.0) < kGravityBand) up_ = f.normalized();
}

void StartFinder::use(const PoseCapture& sample) {
  if (!sample.valid) return;
  if (sample.has_attitude) attitude_ = sample.q_WB;
  if (sample.has_position) position_ = sample.p_WB;
}

void StartFinder::use(const Usbl& sample) {
  if (sample.valid) position_ = sample.p_WB;
}

void StartFinder::use(const Ranges& sample) {
  std::vector<double> ranges = sample.range;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (i >= sample.valid.size() || sample.valid[i] == 0) ranges[i] = 0.0;
  }
  ++ranges_heard_;
  const Verdict verdict = agree(settings_->transponders, ranges, depth_, 5.0 * settings_->range_noise);
  if (verdict.agreement == Agreement::kAllButOne) ranges[verdict.odd] = 0.0;
  if (verdict.agreement == Agreement::kNone && elapsed_ < kPatience) return;  // a better message may come
  const auto place = locate(settings_->transponders, ranges, depth_, kTolerance);
  if (place) position_ = place;
}

void StartFinder::use(const TagPose& sample) {
  for (const KnownTag& tag : settings_->tags) {
    for (const KnownCamera& camera : settings_->cameras) {
      if (tag.number != sample.tag || camera.name != sample.camera) continue;
      if (settings_->tag_attitude) {
        const model::Pose body = model::body_from_tag(tag.X_WT, {sample.p_CT, sample.q_CT}, camera.X_BC);
        position_ = body.p;
        attitude_ = body.q;
      } else if (attitude_) {
        position_ = tag.X_WT.p - *attitude_ * (camera.X_BC.p + camera.X_BC.q * sample.p_CT);
      }
    }
  }
}

std::optional<KalmanStart> StartFinder::found() const {
  if (!attitude_ && !(heading_ && up_)) return std::nullopt;
  const bool unmeasured = !awaited_ && settings_->transponders.empty() && elapsed_ > kPatience;
  if (!position_ && !settings_->start && !unmeasured) return std::nullopt;
  KalmanStart start;
  if (attitude_) {
    start.x.segment<3>(at::kAngles) = euler_from_rotation(attitude_->toRotationMatrix());
  } else {  // at rest the specific force points up: f_B = -g down_B
    const Eigen::Vector3d down = -*up_;
    start.x.segment<3>(at::kAngles) << std::atan2(down.y(), down.z()), -std::asin(std::clamp(down.x(), -1.0, 1.0)),
        *heading_;
  }
  start.x.segment<3>(at::kPosition) = settings_->start.value_or(position_.value_or(Eigen::Vector3d::Zero()));
  if (!settings_->start && !position_ && depth_) start.x[at::kPosition + 2] = *depth_;
  const KalmanSettings& s = *settings_;
  const bool fix = position_ || s.start;
  start.sigma.segment<3>(at::kPosition).setConstant(fix ? s.start_position : 1e-3);
  if (!fix) start.sigma[at::kPosition + 2] = s.start_position;
  start.sigma.segment<3>(at::kVelocity).setConstant(s.start_velocity);
  start.sigma.segment<3>(at::kAngles).setConstant(std::max(s.start_tilt, kSwimRoll));
  start.sigma.segment<3>(at::kAcceleration).setConstant(s.start_acceleration);
  start.sigma.segment<3>(at::kRates).setConstant(s.start_rates);
  start.sigma.segment<3>(at::kRateSlopes).setConstant(s.start_acceleration);
  start.sigma.segment<3>(at::kBias).setConstant(s.accelerometer_bias);
  start.sigma.segment<3>(at::kBias + 3).setConstant(s.gyro_bias);
  start.sigma.segment<3>(at::kLogBias).setConstant(s.velocity_bias);
  for (std::size_t i = 0; i < s.singles.size(); ++i) {
    const bool force = s.singles[i].mount.measures == model::SingleInertialMount::Measures::kForce;
    start.sigma[at::kSingleBias + static_cast<Eigen::Index>(i)] = force ? s.accelerometer_bias : s.gyro_bias;
  }
  return start;
}

std::string StartFinder::missing() const {
  if (!attitude_ && !heading_ && !up_) return "no sensor tells the attitude at the start";
  if (!attitude_ && !heading_) return "no sensor tells the heading at the start";
  if (!attitude_ && !up_) return "no accelerometer tells the vertical at the start";
  const std::size_t count = settings_->transponders.size();
  if (count > 0 && count < 3) {
    return std::to_string(count) + " transponders do not fix a position (a mirror image fits as well); state where " +
           "the run begins (start: {at: ...}) or give three";
  }
  if (ranges_heard_ > 0) {
    return "no three ranges at a time agree on a position at the start; check the transponders' places or state " +
           std::string{"where the run begins (start: {at: ...})"};
  }
  return "the run is too short to begin";
}

}  // namespace fathom::estimation
