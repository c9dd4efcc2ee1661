#include "common/estimation/online/kinematic_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/model/sensors/accelerometer.hpp"
#include "common/model/sensors/attitude.hpp"
#include "common/model/sensors/gyro.hpp"
#include "common/model/sensors/heading.hpp"
#include "common/model/sensors/level_floor.hpp"
#include "common/model/sensors/position.hpp"
#include "common/model/sensors/pressure.hpp"
#include "common/model/sensors/range.hpp"
#include "common/model/sensors/velocity_log.hpp"

namespace fathom::estimation {
namespace {

namespace at = model::at;

constexpr double kAgreeing = 3.0;     // noises by which ranges of one message may miss a common place
constexpr double kWide = 2.0;         // noises of a range: a position less sure than that cannot gate outliers
constexpr int kRangePatience = 4;     // the same of ranges, which are seldom
constexpr int kPatience = 6;          // refused in a row before the estimate is taken to be the one that is wrong
constexpr double kLongestStep = 0.2;  // s, of one linear prediction
constexpr double kNearWall = 0.1;     // m: what position and tilt are off by at the far end of a view, and the corner
constexpr std::array<const char*, kFirstRange> kNames{"accelerometer", "gyro", "heading",      "attitude",
                                                      "depth",         "dvl",  "usbl",         "pose position",
                                                      "pose attitude", "tag",  "optical flow", "laser"};

double square(double value) { return value * value; }

}  // namespace

template <int N>
KinematicEstimator<N>::KinematicEstimator(const KalmanSettings& settings) : settings_{&settings} {
  for (const char* name : kNames) statistics_.push_back({.name = name});
  for (const Transponder& one : settings.transponders) statistics_.push_back({.name = "range " + one.name});
  for (const SingleInertial& one : settings.singles) statistics_.push_back({.name = one.mount.signal});
  in_a_row_.assign(statistics_.size(), 0);
  ranges_.assign(settings.transponders.size(), 0.0);
}

template <int N>
void KinematicEstimator<N>::start(Utime utime, const KalmanStart& start) {
  if (settings_->model == KinematicModel::kPrinted) {
    filter_.start(start.x.head<N>(), start.sigma.head<N>());
  } else {
    typename KalmanFilter<N>::State x = start.x.head<N>();
    x.template segment<3>(at::kAngles).setZero();
    filter_.start(x, start.sigma.head<N>(), rotation_from_euler(start.x.segment<3>(at::kAngles)));
  }
  now_ = utime;
  started_ = true;
}

template <int N>
void KinematicEstimator<N>::advance(Utime utime, FilterRecord<N>* record) {
  record_ = record;
  open_ = false;
  oriented_ = oriented_ && filter_.tells_attitude();
  double left = seconds_between(now_, utime);
  now_ = utime;
  while (left > 0.0) {
    const double dt = left > kLongestStep ? std::min(kLongestStep, 0.5 * left) : left;
    filter_.predict(dt, settings_->process, settings_->model);
    oriented_ = oriented_ && filter_.tells_attitude();
    left -= dt;
    if (left > 0.0 && record != nullptr) record->add(true, filter_);
    open_ = true;
  }
}

template <int N>
void KinematicEstimator<N>::close(FilterRecord<N>* record) {
  if (record != nullptr) record->add(open_, filter_);
}

template <int N>
void KinematicEstimator<N>::take(const SampleView& sample, FilterRecord<N>* record) {
  record_ = record;
  moved_.setZero();
  std::visit([this](const auto* one) { this->use(*one); }, sample);
}

// An instrument that is refused many times in a row is believed again, and what it measures is as open as at the start.
template <int N>
void KinematicEstimator<N>::doubt(std::size_t instrument) {
  typename KalmanFilter<N>::State sigma = KalmanFilter<N>::State::Zero();
  if (instrument == kHeading || instrument == kAttitude || instrument == kPoseAttitude || instrument == kTag) {
    sigma.template segment<3>(at::kAngles).setConstant(settings_->start_tilt);
    sigma.template segment<3>(at::kRates).setConstant(settings_->start_rates);
  }
  const bool depth_alone = instrument == kDepth || instrument == kLaser;
  const bool velocity_alone = instrument == kDvl || instrument == kFlow;
  if (depth_alone) {
    sigma[at::kPosition + 2] = settings_->start_position;
    sigma[at::kVelocity + 2] = settings_->start_velocity;
  } else if (instrument != kHeading && instrument != kAttitude && instrument != kPoseAttitude) {
    sigma.template segment<3>(at::kPosition).setConstant(velocity_alone ? 0.0 : settings_->start_position);
    sigma.template segment<3>(at::kVelocity).setConstant(settings_->start_velocity);
  }
  filter_.doubt(sigma);
  in_a_row_[instrument] = 0;
}

// Of several transponders one may be in the wrong place, so that most must be refused, and several times in a row,
// before the position is taken to be the one that is wrong. It is then as open as at the beginning.
template <int N>
void KinematicEstimator<N>::doubt_if_lost() {
  std::size_t lost = 0, used = 0;
  for (std::size_t i = kFirstRange; i < first_single(); ++i) {
    used += settings_->transponders[i - kFirstRange].used ? 1 : 0;
    lost += in_a_row_[i] > kRangePatience ? 1 : 0;
  }
  if (2 * lost <= used) return;
  typename KalmanFilter<N>::State sigma = KalmanFilter<N>::State::Zero();
  sigma.template segment<3>(at::kPosition).setConstant(settings_->start_position);
  sigma.template segment<3>(at::kVelocity).setConstant(settings_->start_velocity);
  filter_.doubt(sigma);
  std::fill_n(in_a_row_.begin() + kFirstRange, settings_->transponders.size(), 0);
}

template <int N>
void KinematicEstimator<N>::apply(std::size_t instrument, const model::Observation& observation) {
  InnovationStatistics& statistics = statistics_[instrument];
  // They err by noise, not by leaps.
  const bool inertial = instrument == kAccelerometer || instrument == kGyro || instrument >= first_single();
  const double gate = inertial ? std::numeric_limits<double>::max() : settings_->gate;
  if (instrument < kFirstRange && in_a_row_[instrument] > kPatience) doubt(instrument);
  const auto outcome = filter_.update(observation, gate, moved_);
  if (!std::isfinite(outcome.variance)) {
    ++statistics.dropped;
    return;
  }
  in_a_row_[instrument] = outcome.used ? 0 : in_a_row_[instrument] + 1;
  // A refused one counts as if it lay at the gate: a filter cannot look good by refusing.
  const double surprise = std::min(outcome.nis(), square(gate));
  statistics.surprise_sum += surprise;
  statistics.likelihood -= 0.5 * (surprise + std::log(2.0 * std::numbers::pi * outcome.variance));
  if (!outcome.used) {
    ++statistics.refused;
    return;
  }
  ++statistics.used;
  statistics.nis_sum += outcome.nis();
  if (record_ != nullptr) record_->add(observation, outcome);
}

template <int N>
void KinematicEstimator<N>::use(const Ahrs& sample) {
  const KalmanSettings& s = *settings_;
  const model::KinematicPoint point = filter_.point();
  const bool biases = N > model::kKinematicStates;
  const Eigen::Vector3d f = sample.f_B, w = sample.w_WB_B;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d direction = s.R_BI.col(i);
    if (sample.has_specific_force) {
      const model::Accelerometer sensor{s.p_BI, direction, biases ? i : -1, s.gravity};
      apply(kAccelerometer, observe(point, sensor, f[i], square(s.accelerometer_noise[i])));
    }
    if (sample.has_rates) {
      apply(kGyro, observe(point, model::Gyro{direction, biases ? 3 + i : -1}, w[i], square(s.gyro_noise[i])));
    }
  }
  if (!sample.has_attitude) return;
  if (s.attitude == AttitudeUse::kHeading) {
    const double heading = euler_from_rotation(sample.q_WB.toRotationMatrix()).z();
    apply(kHeading, observe_heading(point, s.declination, heading,
                                    square(s.heading_noise.value_or(KalmanSettings::kHeadingNoise))));
  } else if (s.attitude == AttitudeUse::kEverything) {
    // Errors that go on for `memory` have this density at slow frequencies, where the gyro does not know better.
    const double apart = attitude_ ? seconds_between(*attitude_, sample.utime) : s.attitude_memory;
    const double repeats = apart > 0.0 ? std::max(1.0, 2.0 * s.attitude_memory / apart) : 1.0;
    const double share = attitude_ ? repeats : 1.0;
    const double tilt = square(s.attitude_noise) * share;
    const double heading = square(s.heading_noise.value_or(s.attitude_noise)) * share;
    const auto rows = heading == tilt ? observe_attitude(point, sample.q_WB, tilt)
                                      : observe_attitude(point, sample.q_WB, Eigen::Vector3d(tilt, tilt, heading));
    for (const auto& row : rows) apply(kAttitude, row);
    attitude_ = sample.utime;
  }
}

template <int N>
void KinematicEstimator<N>::use(const Signal& sample) {
  const KalmanSettings& s = *settings_;
  const auto which = s.single(sample.name);
  if (!which) return;
  const model::SingleInertialMount& mount = s.singles[*which].mount;
  if (sample.unit != mount.unit()) {
    ++statistics_[first_single() + *which].dropped;
    return;
  }
  const model::KinematicPoint point = filter_.point();
  const int bias = at::kSingleBias - at::kBias + static_cast<int>(*which);
  const bool force = mount.measures == model::SingleInertialMount::Measures::kForce;
  const double noise = s.singles[*which].noise.value_or((force ? s.accelerometer_noise : s.gyro_noise).mean());
  const model::Observation row = force ? observe(point, model::Accelerometer{mount.p_BS, mount.axis_B, bias, s.gravity},
                                                 sample.value, square(noise))
                                       : observe(point, model::Gyro{mount.axis_B, bias}, sample.value, square(noise));
  apply(first_single() + *which, row);
}

template <int N>
void KinematicEstimator<N>::use(const PoseCapture& sample) {
  if (!sample.valid) {
    ++statistics_[kPosePosition].dropped;
    return;
  }
  const model::KinematicPoint point = filter_.point();
  const Eigen::Vector3d variance = Eigen::Vector3d::Constant(square(settings_->position_noise));
  if (sample.has_position) {
    for (const auto& row : observe_position(point, Eigen::Vector3d::Zero(), sample.p_WB, variance)) {
      apply(kPosePosition, row);
    }
  }
  if (!sample.has_attitude) return;
  for (const auto& row : observe_attitude(point, sample.q_WB, square(settings_->capture_attitude_noise))) {
    apply(kPoseAttitude, row);
  }
}

template <int N>
void KinematicEstimator<N>::use(const Dvl& sample) {
  if (!sample.valid || sample.held) {
    ++statistics_[kDvl].dropped;
    return;
  }
  const model::KinematicPoint point = filter_.point();
  const double variance = square(settings_->velocity_noise);
  const Eigen::Vector3d v_B = settings_->velocity_scale.cwiseProduct(sample.v_WB_B);
  for (const auto& row : observe_velocity(point, Eigen::Vector3d::Zero(), v_B, variance, N > model::kInertialStates))
    apply(kDvl, row);
}

template <int N>
void KinematicEstimator<N>::use(const Depth& sample) {
  const model::KinematicPoint point = filter_.point();
  apply(kDepth, observe_depth(point, settings_->p_BP, sample.z, square(settings_->depth_noise)));
}

template <int N>
void KinematicEstimator<N>::use(const Usbl& sample) {
  if (!sample.valid) {
    ++statistics_[kUsbl].dropped;
    return;
  }
  const model::KinematicPoint point = filter_.point();
  const Eigen::Vector3d variance = sample.sigma.array().square() + square(settings_->usbl_noise);
  for (const auto& row : observe_position(point, Eigen::Vector3d::Zero(), sample.p_WB, variance)) {
    apply(kUsbl, row);
  }
}

// A wide covariance lets an outlier of metres pass the gate; but the ranges of one message can be asked to agree.
template <int N>
void KinematicEstimator<N>::doubt_odd_ranges(const Ranges& sample, const model::KinematicPoint& point) {
  const auto counts = [&](std::size_t i) {  // one that is left out neither witnesses nor is judged
    return settings_->transponders[i].used && i < sample.range.size() && i < sample.valid.size() &&
           sample.valid[i] != 0;
  };
  for (std::size_t i = 0; i < ranges_.size(); ++i) ranges_[i] = counts(i) ? sample.range[i] : 0.0;
  const double sigma = std::sqrt(filter_.covariance().diagonal().template segment<2>(at::kPosition).maxCoeff());
  if (sigma < kWide * settings_->range_noise) return;
  const double depth = point.x[at::kPosition + 2] + point.down_B.dot(settings_->p_BA);
  const Verdict verdict = agree(settings_->transponders, ranges_, depth, kAgreeing * settings_->range_noise);
  if (verdict.agreement == Agreement::kAllButOne) ranges_[verdict.odd] = 0.0;
  if (verdict.agreement == Agreement::kNone) std::fill(ranges_.begin(), ranges_.end(), 0.0);
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    if (!counts(i) || ranges_[i] > 0.0) continue;
    ranges_[i] = -1.0;  // heard, but refused
    ++statistics_[kFirstRange + i].refused;
    statistics_[kFirstRange + i].surprise_sum += square(settings_->gate);
  }
}

// A range that was not heard has infinite variance.
template <int N>
void KinematicEstimator<N>::use(const Ranges& sample) {
  doubt_if_lost();
  const model::KinematicPoint point = filter_.point();
  doubt_odd_ranges(sample, point);
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    if (!settings_->transponders[i].used || ranges_[i] < 0.0) continue;
    const bool heard = ranges_[i] > 0.0;
    const double variance = heard ? square(settings_->range_noise) : std::numeric_limits<double>::infinity();
    apply(kFirstRange + i,
          observe_range(point, settings_->p_BA, settings_->transponders[i].p_WT, ranges_[i], variance));
  }
}

template <int N>
const KnownCamera* KinematicEstimator<N>::camera(const std::string& name) const {
  const auto found = std::ranges::find(settings_->cameras, name, &KnownCamera::name);
  return found == settings_->cameras.end() ? nullptr : &*found;
}

template <int N>
void KinematicEstimator<N>::use(const TagPose& sample) {
  const KnownCamera* by = camera(sample.camera);
  const auto tag = std::ranges::find(settings_->tags, sample.tag, &KnownTag::number);
  if (by == nullptr || tag == settings_->tags.end()) {
    ++statistics_[kTag].dropped;
    return;
  }
  const model::KinematicPoint point = filter_.point();
  const double along = square(settings_->tag_noise * sample.p_CT.norm());
  const auto rows = observe_tag(point, tag->X_WT, by->X_BC, {sample.p_CT, sample.q_CT}, along / 9.0, along,
                                square(settings_->tag_attitude_noise));
  for (std::size_t i = 0; i < (settings_->tag_attitude ? 6U : 3U); ++i) apply(kTag, rows[i]);
}

// A tilted vehicle looks at a wall now and then, and along the wall range and scene change so gently that no gate
// notices.
template <int N>
bool KinematicEstimator<N>::within_walls(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kNearWall);
  return Eigen::AlignedBox2d{settings_->walls.min() + margin, settings_->walls.max() - margin}.contains(
      Eigen::Vector2d{p_W.head<2>()});
}

template <int N>
void KinematicEstimator<N>::use(const OpticalFlow& sample) {
  const KnownCamera* by = camera(sample.camera);
  const model::KinematicPoint point = filter_.point();
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  const auto distance =
      by != nullptr ? model::distance_to_floor(point, *settings_->floor, by->X_BC, axis) : std::nullopt;
  if (!distance ||
      !within_walls(point.group(at::kPosition) + point.R_WB * (by->X_BC.p + *distance * (by->X_BC.q * axis)))) {
    ++statistics_[kFlow].dropped;
    return;
  }
  // A scale of what is read, along B, seen by the camera.
  Eigen::Vector3d read = sample.flow_C;
  if (!sample.tells_approach()) read.z() = 0.0;
  const Eigen::Vector3d flow = by->X_BC.q.conjugate() * settings_->flow_scale.cwiseProduct(by->X_BC.q * read);
  const Eigen::Vector3d variance =
      Eigen::Vector3d{sample.covariance.diagonal()}.array() + square(settings_->flow_noise / *distance);
  const auto rows = observe_flow(point, *settings_->floor, by->X_BC, flow, variance);
  for (std::size_t i = 0; i < (sample.tells_approach() ? 3 : 2); ++i) apply(kFlow, (*rows)[i]);
}

template <int N>
void KinematicEstimator<N>::use(const LaserRange& sample) {
  const KnownCamera* by = camera(sample.camera);
  const model::KinematicPoint point = filter_.point();
  if (by == nullptr ||
      !within_walls(point.group(at::kPosition) + point.R_WB * (by->X_BC.p + by->X_BC.q * sample.p_CL))) {
    ++statistics_[kLaser].dropped;
    return;
  }
  const double variance = square(sample.sigma_range) + square(settings_->laser_noise);
  const auto row = observe_floor_point(point, *settings_->floor, by->X_BC, sample.p_CL, variance);
  row ? apply(kLaser, *row) : static_cast<void>(++statistics_[kLaser].dropped);
}

template <int N>
double KinematicEstimator<N>::likelihood() const {
  double sum = 0.0;
  for (const InnovationStatistics& one : statistics_) sum += one.likelihood;
  return sum;
}

StateEstimate state_of(Utime utime, const model::KinematicVector& x, const model::KinematicVector& variance,
                       const std::optional<Eigen::Matrix3d>& reference) {
  const model::KinematicPoint point{x, reference};
  StateEstimate state;
  state.utime = utime;
  state.p_WB = point.group(at::kPosition);
  state.q_WB = Eigen::Quaterniond{point.R_WB}.normalized();
  state.nu << point.R_WB.transpose() * point.group(at::kVelocity), point.group(at::kRates);
  const Eigen::Matrix3d turn2 = point.R_WB.transpose().cwiseAbs2(), angles2 = point.turn_from_angles.cwiseAbs2();
  state.sigma << variance.segment<3>(at::kPosition), angles2 * variance.segment<3>(at::kAngles),
      turn2 * variance.segment<3>(at::kVelocity), variance.segment<3>(at::kRates);
  state.sigma = state.sigma.cwiseMax(0.0).cwiseSqrt().eval();
  state.valid = true;
  return state;
}

template class KinematicEstimator<model::kKinematicStates>;
template class KinematicEstimator<model::kInertialStates>;
template class KinematicEstimator<model::kLoggedStates>;
template class KinematicEstimator<model::kMostStates>;

}  // namespace fathom::estimation
