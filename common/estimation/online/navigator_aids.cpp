// What each measurement of a trial does to the filter, and the gains with which it does.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/estimation/online/navigator.hpp"

namespace fathom::estimation {
namespace {

constexpr int kPatience = 8;              // refused in a row before the estimate is taken to be the one that is wrong
constexpr int kWitness = 3;               // accepted samples that make a source trusted
constexpr double kMoving = 0.01;          // m/s and rad/s, together
constexpr double kClearly = 0.05;         // the same beyond any noise: at rest what is quantised repeats itself
constexpr double kLongestInterval = 1.0;  // s for gains: beyond, they are as good as one
constexpr double kStartSigma = 0.5;       // m/s: what vehicles of this size do
constexpr double kLargestTiltCosine =
    0.5;                           // of 60 deg; beyond, what is seen across the body hardly tells the horizontal
constexpr double kNearWall = 0.1;  // m: what position and tilt are off by at the far end of the view, and the corner
constexpr double kTogether = 0.2;  // s: tags that were seen so lately are in sight
constexpr double kTagsCommonError = 4.0;  // tags in one picture share errors: they count as this many at most

std::size_t slot(Source source) { return static_cast<std::size_t>(source); }

}  // namespace

bool Navigator::frozen(Memory& memory, const Measurement& m, const Input& input) const {
  Track& track = memory.tracks[slot(m.source)];
  if (!track.last || m.a != track.a || m.b != track.b) {
    track.repeated = track.moved = 0;
    track.a = m.a;
    track.b = m.b;
    return false;
  }
  const double speed = memory.filter.velocity().norm() + input.w_B.norm();
  if (track.repeated++ == 0) track.moved = speed > kMoving ? kRepeats : 0;
  if (speed > kClearly) ++track.moved;
  return track.repeats();
}

void Navigator::use(Memory& memory, std::size_t first, std::size_t last, const Input& input) const {
  const Measurement& m = waiting_[first];
  Track& track = memory.tracks[slot(m.source)];
  if (m.source == Source::kTagPose) return use_tags(memory, first, last, input);
  for (std::size_t i = first; i < last; ++i) {
    const Measurement& one = waiting_[i];
    if (!one.counts) continue;
    if (frozen(memory, one, input)) {
      ++track.rejected[kFrozen];
      continue;
    }
    const double noise = aid(one.source).noise;
    const Eigen::Vector3d ones = Eigen::Vector3d::Ones();
    switch (one.source) {
      case Source::kOpticalFlow:
        use_flow(memory, one, input);
        break;
      case Source::kLaserRange:
        use_laser(memory, one, input);
        break;
      case Source::kDvl:
        use_velocity(memory, one, settings_.dvl.scale.cwiseProduct(one.a), ones, noise * noise * ones, input);
        break;
      case Source::kUsbl: {
        const Eigen::Vector3d variance = one.b.cwiseAbs2() + noise * noise * ones;
        // Depth from pressure is better by far, and its offset from the fixes must not pull.
        const bool depth = memory.tracks[slot(Source::kDepth)].last.has_value();
        use_position(memory, one, one.a, depth ? Eigen::Vector3d{1.0, 1.0, 0.0} : ones, variance, input);
        break;
      }
      default:
        use_position(memory, one, one.a, Eigen::Vector3d::UnitZ(), noise * noise * ones, input);
    }
  }
}

void Navigator::use_tags(Memory& memory, std::size_t first, std::size_t last, const Input& input) const {
  const Eigen::Matrix3d R_WB = input.q_WB.toRotationMatrix();
  Track& track = memory.tracks[slot(Source::kTagPose)];
  const double noise = settings_.tags.noise;
  // Tags that agree with most of the picture's others; one alone has nobody to ask but the filter.
  Eigen::Vector3d median = Eigen::Vector3d::Zero();
  int n = 0;
  std::array<double, 32> values{};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    n = 0;
    for (std::size_t i = first; i < last && n < 32; ++i) {
      const Measurement& one = waiting_[i];
      if (one.counts) values[static_cast<std::size_t>(n++)] = one.a[axis] - R_WB.row(axis).dot(one.b);
    }
    std::nth_element(values.begin(), values.begin() + n / 2, values.begin() + n);
    median[axis] = values[static_cast<std::size_t>(n / 2)];
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double agreed = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const Measurement& one = waiting_[i];
    if (!one.counts) continue;
    const Eigen::Vector3d p_WB = one.a - R_WB * one.b;
    if (n > 2 && (p_WB - median).cwiseAbs().maxCoeff() > settings_.gate * noise) {
      ++track.rejected[kGated];
      continue;
    }
    sum += p_WB;
    agreed += 1.0;
  }
  if (agreed == 0.0) return;
  Measurement together = waiting_[first];
  if (frozen(memory, together, input)) {
    ++track.rejected[kFrozen];
    return;
  }
  together.a = sum / agreed;
  const double down = settings_.tags.vertical_noise > 0.0 ? settings_.tags.vertical_noise : noise;
  const double count = std::min(agreed, kTagsCommonError);
  const Eigen::Vector3d variance = Eigen::Vector3d{noise * noise, noise * noise, down * down} / count;
  use_position(memory, together, together.a, Eigen::Vector3d::Ones(), variance, input);
}

// What is seen at p_B tells of the floor only where the floor is: a tilted vehicle looks at a wall now and then, and
// along the wall range and scene change so gently that no gate notices. Nothing is known before there is a position.
bool Navigator::of_floor(Memory& memory, const Measurement& m, const Eigen::Vector3d& p_B,
                         const Eigen::Matrix3d& R_WB) const {
  if (!memory.started) return true;
  Track& track = memory.tracks[slot(m.source)];
  const Eigen::Vector2d at = (memory.filter.position() + R_WB * p_B).head<2>();
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kNearWall);
  track.walled = !Eigen::AlignedBox2d{places_.walls.min() + margin, places_.walls.max() - margin}.contains(at);
  track.rejected[kWall] += track.walled ? 1 : 0;
  return !track.walled;
}

void Navigator::use_flow(Memory& memory, const Measurement& m, const Input& input) const {
  if (!memory.started) return;
  const Eigen::Matrix3d R_WB = input.q_WB.toRotationMatrix();
  const double distance = distance_to_floor(*places_.floor, memory.filter.position(), *m.camera, R_WB);
  if (!(distance > 0.0)) return;
  if (!of_floor(memory, m, m.camera->p_BC + distance * m.camera->R_BC.col(2), R_WB)) return;
  const Eigen::Vector3d by_flow = velocity_from_flow(m.a, distance);
  // The paper's gains want all three. Ours are for what is seen across the optical axis: laser and tags tell the height
  // to millimetres, which a picture's growth does not, and along the axis the estimate stands in for the measurement.
  const bool approach = settings_.published_gains && m.b.z() >= 0.0;
  const Eigen::Vector3d v_B = R_WB.transpose() * memory.filter.velocity();
  Eigen::Vector3d v_C = velocity_of_camera(v_B, input.w_B, *m.camera);
  v_C.head(approach ? 3 : 2) = by_flow.head(approach ? 3 : 2);
  const Eigen::Vector3d seen =
      settings_.flow.scale.cwiseProduct(m.camera->R_BC * v_C - input.w_B.cross(m.camera->p_BC));
  // What is not known of the height is an error of scale.
  const double height = std::sqrt(memory.filter.covariance()[2].pp) / distance * by_flow.head<2>().norm();
  const double sigma = std::hypot(settings_.flow.noise, distance * m.sigma) + height;
  Eigen::Vector3d variance = Eigen::Vector3d::Constant(sigma * sigma);
  if (approach) variance += distance * distance * m.b.z() * (m.camera->R_BC.col(2)).cwiseAbs2();
  use_velocity(memory, m, seen, {1.0, 1.0, approach ? 1.0 : 0.0}, variance, input);
}

void Navigator::use_laser(Memory& memory, const Measurement& m, const Input& input) const {
  const Eigen::Matrix3d R_WB = input.q_WB.toRotationMatrix();
  if (!of_floor(memory, m, m.camera->p_BC + m.camera->R_BC * m.a, R_WB)) return;
  const double z = depth_from_floor_point(*places_.floor, m.a, *m.camera, R_WB);
  const double sigma = std::hypot(settings_.laser.noise, m.sigma);
  use_position(memory, m, {0.0, 0.0, z}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Constant(sigma * sigma), input);
}

AxisGains published_gains(Source source) {
  AxisGains k;
  if (source == Source::kTagPose) k.value = {0.09, 0.09, 0.05};
  if (source == Source::kLaserRange) k.value = {0.0, 0.0, 0.003};
  if (source == Source::kOpticalFlow) {
    k.value = {0.3, 0.3, 0.06};
    k.rate = {0.2, 0.2, 0.2};
  }
  return k;
}

// Cut-offs and damping with the actual interval; or the paper's numbers, which take the interval for granted.
AxisGains Navigator::gains(Source source, double interval, bool) const {
  if (settings_.published_gains) return published_gains(source);
  AxisGains k;
  const AidSettings& s = aid(source);
  if (source == Source::kDvl || source == Source::kOpticalFlow) {
    // The whole interval, however long: what a silence leaves is a bias times its length, and the share that the bias
    // gets falls with it.
    const double dt = std::max(interval, 0.0);
    const Gains across = second_order_gains(s.cutoff, s.damping, dt);
    const Gains down = source == Source::kDvl ? second_order_gains(s.vertical_cutoff, s.vertical_damping, dt) : Gains{};
    k.value = {across.value, across.value, down.value};
    k.rate = {across.rate, across.rate, down.rate};
    return k;
  }
  const double dt = std::clamp(interval, 0.0, kLongestInterval);
  if (s.cutoff > 0.0) {
    const double across = first_order_gains(s.cutoff, dt).value;
    k.value = {across, across, 0.0};
  }
  if (s.vertical_cutoff > 0.0) {
    const Gains down = vertical_velocity_ ? first_order_gains(s.vertical_cutoff, dt)
                                          : proportional_third_order_gains(s.vertical_cutoff, s.vertical_damping, dt);
    k.value.z() = down.value;
    k.rate.z() = down.rate;
    k.second.z() = down.second;
  }
  return k;
}

// A source that has hardly been heard, perhaps beginning with a wild sample, is no witness against its next ones.
bool Navigator::outvoted(const Track& track) { return track.refused > (track.accepted < kWitness ? 1 : kPatience); }

bool Navigator::passes(Track& track, double worst) const {
  if (worst <= settings_.gate) {
    track.refused = 0;
    ++track.accepted;
    return true;
  }
  ++track.rejected[kGated];
  ++track.refused;
  return false;
}

// Tags and laser tell depth at the same cut-off, as often as one another. A laser's range errs with the square of the
// distance, by a centimetre from a metre on, where tags have company: then it counts for less, but never for nothing,
// and it stands alone where tags are out of sight.
double Navigator::share_of_laser(const Memory& memory, const Measurement& m, double variance) const {
  const std::optional<Utime>& tags = memory.tracks[slot(Source::kTagPose)].last;
  if (settings_.published_gains || !tags || seconds_between(*tags, m.utime) > kTogether) return 1.0;
  const double of_tags = settings_.tags.noise * settings_.tags.noise / kTagsCommonError;
  return std::min(1.0, 2.0 * of_tags / (variance + of_tags));
}

void Navigator::use_position(Memory& memory, const Measurement& m, const Eigen::Vector3d& p_WB,
                             const Eigen::Vector3d& axes, const Eigen::Vector3d& variance, const Input& input) const {
  Track& track = memory.tracks[slot(m.source)];
  if (!memory.started) {
    if (axes.head<2>().minCoeff() <= 0.0) return;  // depth alone says not where
    memory.filter.start(p_WB, variance.cwiseSqrt(), Eigen::Vector3d::Zero(), kStartSigma);
    memory.started = true;
    track.last = m.utime;
    return;
  }
  const Eigen::Vector3d innovation = axes.cwiseProduct(p_WB - memory.filter.position());
  double worst = 0.0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    // A tilt moves what is noise across to where it is not, so the gate is as wide as the widest axis.
    const double spread = std::sqrt(memory.filter.covariance()[static_cast<std::size_t>(i)].pp + variance.maxCoeff());
    worst = std::max(worst, std::abs(innovation[i]) / spread);
  }
  if (!passes(track, worst)) {
    if (!outvoted(track)) return;
    memory.filter.set_position(p_WB, axes, variance);
    track.refused = 0;
    track.last = m.utime;
    return;
  }
  const double interval = track.last ? seconds_between(*track.last, m.utime) : kLongestInterval;
  AxisGains k = gains(m.source, interval, vertical_velocity_);
  k.value = k.value.cwiseProduct(axes);
  k.rate = k.rate.cwiseProduct(axes);
  k.second = k.second.cwiseProduct(axes);
  const double share = m.source == Source::kLaserRange ? share_of_laser(memory, m, variance.z()) : 1.0;
  k.value.z() *= share;
  k.rate.z() *= share;
  k.second.z() *= share;
  memory.filter.correct_position(innovation, k, variance, input.q_WB.toRotationMatrix());
  track.last = m.utime;
}

void Navigator::use_velocity(Memory& memory, const Measurement& m, const Eigen::Vector3d& v_B,
                             const Eigen::Vector3d& axes, const Eigen::Vector3d& variance, const Input& input) const {
  if (!memory.started) return;
  Track& track = memory.tracks[slot(m.source)];
  const Eigen::Matrix3d R_WB = input.q_WB.toRotationMatrix();
  const Eigen::Vector3d innovation = axes.cwiseProduct(v_B - R_WB.transpose() * memory.filter.velocity());
  double worst = 0.0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double spread = std::sqrt(memory.filter.covariance()[static_cast<std::size_t>(i)].vv + variance[i]);
    worst = std::max(worst, std::abs(innovation[i]) / spread);
  }
  const bool fits = passes(track, worst);
  if (!fits && !outvoted(track)) return;
  // The first one tells how fast the vehicle was all along, and nothing of the accelerometer: taken as an innovation it
  // would go into the bias, which then drives STATE away as soon as the instrument is silent.
  if (!fits || !track.last) {
    memory.filter.set_velocity(memory.filter.velocity() + R_WB * innovation, axes, variance);
    track.refused = 0;
    track.last = m.utime;
    return;
  }
  const double interval = seconds_between(*track.last, m.utime);
  track.last = m.utime;
  const AxisGains k = gains(m.source, interval, true);
  if (axes.z() > 0.0 || settings_.published_gains || R_WB(2, 2) < kLargestTiltCosine) {
    memory.filter.correct_velocity(innovation, k, variance, R_WB);
    return;
  }
  // Seen across the body's z axis alone. Corrected along the body's axes, a tilted vehicle's horizontal error would
  // turn into a vertical one, which depth takes out more slowly than it comes. The vertical velocity is depth's to
  // tell, so what is seen tells the horizontal one: (R_WB' [dv; 0]) across the body's z axis is the innovation.
  const Eigen::Matrix2d back = R_WB.topLeftCorner<2, 2>().transpose().inverse();
  memory.filter.correct_horizontal_velocity(back * innovation.head<2>(), k, back.cwiseAbs2() * variance.head<2>(),
                                            R_WB);
}

}  // namespace fathom::estimation
