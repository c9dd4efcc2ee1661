// What arrives for the joint estimate, and how far each sample is believed.
#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/joint/joint_estimate.hpp"
#include "common/joint/joint_rows.hpp"

namespace fathom::joint {
namespace {

constexpr double kTagsCommonError = 4.0;  // tags in one picture share errors: they count as this many at most
constexpr int kRepeats = 4;               // bit by bit the same: no noisy sensor does that while moving
constexpr double kNearWall = 0.1;         // m
constexpr int kPatience = 60;             // rows refused in a row before the motion is taken to be the wrong one
constexpr double kLasts = 1.0;            // s that heights and places are off by the same: until other tags are in view
constexpr double kShortest = 5e-3;        // s between two pictures
constexpr double kNearest = 0.05;         // m along the optical axis: nearer nothing is seen

double square(double value) { return value * value; }

}  // namespace

void JointEstimate::correct(std::size_t count, const char* refused) {
  const int taken = filter_.update(std::span{at_once_}.first(count), navigator_.gate);
  rows_ += taken;
  const int lost = static_cast<int>(count) - taken;
  if (lost > 0) rejected_[refused] += lost;
  refused_in_a_row_ = taken > 0 ? 0 : refused_in_a_row_ + lost;
  if (refused_in_a_row_ > kPatience) lose("nothing fitted");
}

bool JointEstimate::frozen(const Event& event) {
  Seen& seen = seen_[static_cast<std::size_t>(event.kind)];
  const bool same = event.a == seen.a && event.b == seen.b;
  seen.a = event.a;
  seen.b = event.b;
  seen.repeated = same ? seen.repeated + 1 : 0;
  if (seen.repeated < kRepeats) return false;
  ++rejected_["joint estimate: frozen"];
  return true;
}

// An error that lasts for a while, in many samples: as large a noise of each as leaves the same over longer times.
double JointEstimate::lasting(Kind kind, Utime utime, double systematic) {
  Seen& seen = seen_[static_cast<std::size_t>(kind)];
  const double interval = std::clamp(seconds_between(seen.utime, utime), kShortest, kLasts);
  seen.utime = utime;
  return square(systematic) * 2.0 * kLasts / interval;
}

// What is seen at p_B tells of the floor only where the floor is.
bool JointEstimate::of_floor(const Eigen::Vector3d& p_B, const Eigen::Matrix3d& R_WB) const {
  const Eigen::Vector2d at = (filter_.state().segment<3>(part::kPosition) + R_WB * p_B).head<2>();
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kNearWall);
  return Eigen::AlignedBox2d{places_.walls.min() + margin, places_.walls.max() - margin}.contains(at);
}

void JointEstimate::use(std::size_t first, std::size_t last) {
  if (waiting_[first].kind == Kind::kTag) return use_tags(first, last);
  for (std::size_t i = first; i < last; ++i) {
    const Event& event = waiting_[i];
    if (frozen(event)) continue;
    if (event.kind == Kind::kFlow) {
      use_flow(event);
    } else if (event.kind == Kind::kLaser) {
      use_laser(event);
    } else {
      use_others(event);
    }
  }
}

// All tags of one picture together: their mean, of those that the filter can believe.
void JointEstimate::use_tags(std::size_t first, std::size_t last) {
  if (frozen(waiting_[first])) return;
  const Eigen::Matrix3d here = told(waiting_[first].utime), R = true_attitude(filter_.state(), here);
  const Eigen::Vector3d p = filter_.state().segment<3>(part::kPosition);
  const double noise = navigator_.tags.noise;
  const double spread =
      std::sqrt(filter_.covariance().diagonal().segment<3>(part::kPosition).maxCoeff() + square(noise));
  Eigen::Vector3d p_WT = Eigen::Vector3d::Zero(), arm = Eigen::Vector3d::Zero();
  double n = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const Event& event = waiting_[i];
    if ((event.a - R * event.b - p).cwiseAbs().maxCoeff() > navigator_.gate * spread) {
      ++rejected_["joint estimate: TAG_POSE refused"];
      continue;
    }
    p_WT += event.a;
    arm += event.b;
    n += 1.0;
  }
  if (n == 0.0) return static_cast<void>(++refused_in_a_row_);
  see_point(filter_.state(), here, p_WT / n, arm / n, std::span{at_once_}.first<3>());
  const double down = navigator_.tags.vertical_noise > 0.0 ? navigator_.tags.vertical_noise : noise;
  const double count = std::min(n, kTagsCommonError);
  const double stays = lasting(Kind::kTag, waiting_[first].utime, navigator_.tags.systematic);
  at_once_[0].variance = at_once_[1].variance = square(noise) / count + stays;
  at_once_[2].variance = square(down) / count + stays;
  correct(3, "joint estimate: TAG_POSE refused");
}

void JointEstimate::use_laser(const Event& event) {
  const Eigen::Matrix3d here = told(event.utime);
  const Eigen::Vector3d arm = event.camera->p_BC + event.camera->R_BC * event.a;
  if (!of_floor(arm, true_attitude(filter_.state(), here))) return;
  see_floor(filter_.state(), here, *places_.floor, arm, at_once_[0]);
  at_once_[0].variance = square(navigator_.laser.noise) + square(event.sigma) +
                         lasting(Kind::kLaser, event.utime, navigator_.laser.systematic);
  correct(1, "joint estimate: LASER_RANGE refused");
}

void JointEstimate::use_flow(const Event& event) {
  const estimation::CameraMount& camera = *event.camera;
  const Eigen::Matrix3d here = told(event.utime);
  const double away = distance(filter_.state(), here, *places_.floor, camera);
  const Eigen::Vector3d p_B = camera.p_BC + away * camera.R_BC.col(2);
  if (!(away > kNearest) || !of_floor(p_B, true_attitude(filter_.state(), here))) return;
  const Eigen::Vector3d scale = camera.R_BC.cwiseAbs2().transpose() * navigator_.flow.scale;
  see_flow(filter_.state(), here, *places_.floor, camera, event.a.cwiseProduct(scale), std::span{at_once_}.first<3>());
  const bool approach = event.b.z() >= 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    at_once_[i].variance = square(navigator_.flow.noise) + square(away) * event.b[static_cast<Eigen::Index>(i)];
  correct(approach ? 3 : 2, "joint estimate: OPTICAL_FLOW refused");
}

void JointEstimate::use_others(const Event& event) {
  const JointVector& x = filter_.state();
  if (event.kind == Kind::kDvl) {
    see_velocity(x, navigator_.dvl.scale.cwiseProduct(event.a), std::span{at_once_}.first<3>());
    for (std::size_t i = 0; i < 3; ++i) at_once_[i].variance = square(navigator_.dvl.noise);
    return correct(3, "joint estimate: DVL refused");
  }
  if (event.kind == Kind::kDepth) {
    see_state(x, part::kPosition + 2, event.a.z(), at_once_[0]);
    at_once_[0].variance = square(navigator_.depth.noise);
    return correct(1, "joint estimate: DEPTH refused");
  }
  // Fixes: depth from pressure is better by far, and its offset from the fixes must not pull.
  const std::size_t axes = navigator_.depth.used ? 2 : 3;
  for (std::size_t i = 0; i < axes; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    see_state(x, part::kPosition + static_cast<int>(i), event.a[axis], at_once_[i]);
    at_once_[i].variance = square(event.b[axis]) + square(navigator_.usbl.noise) + square(navigator_.usbl.systematic);
  }
  correct(axes, "joint estimate: USBL refused");
}

// Rates as the gyro tells them; then the specific force. What the model lacks moves the vehicle and is felt as well, so
// that process and measurement share noise.
void JointEstimate::use_inertial(const Event& event, double dt) {
  see_rates(filter_.state(), event.a, std::span{at_once_}.first<3>());
  for (std::size_t i = 0; i < 3; ++i) at_once_[i].variance = square(navigator_.rate_noise);
  correct(3, "joint estimate: AHRS refused");
  for (int i = 0; i < 3; ++i) {
    const auto rate = static_cast<std::size_t>(i);
    if (filter_.model().moves(3 + i)) colour_[3 + rate].hear(at_once_[rate].score);
  }
  Eigen::Vector3d w_dot = Eigen::Vector3d::Zero();
  if (attitudes_ >= static_cast<int>(lately_.size())) {
    const Event& old = lately_[static_cast<std::size_t>(attitudes_) % lately_.size()];
    w_dot = (event.a - old.a) / seconds_between(old.utime, event.utime);
  }
  const Eigen::Matrix3d here = event.q_WB.toRotationMatrix();
  const Eigen::Matrix3d carried = before_->q_WB.toRotationMatrix() *
                                  quaternion_from_rotation_vector(0.5 * dt * (before_->a + event.a)).toRotationMatrix();
  const Felt felt{
      .told = here, .carried = carried, .tau = tau_, .w_dot = w_dot, .p_BI = places_.p_BI, .gravity = places_.gravity};
  const std::size_t count = feel_force(filter_.model(), filter_.state(), felt, event.b, std::span{at_once_}.first<3>());
  const double own = navigator_.vertical_acceleration_noise > 0.0 ? navigator_.vertical_acceleration_noise
                                                                  : navigator_.acceleration_noise;
  const double lacks = square(settings_.acceleration), turns = square(settings_.turning) * places_.p_BI.squaredNorm();
  std::size_t i = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!filter_.model().moves(axis)) continue;
    at_once_[i].variance = (square(own) + lacks + turns) / dt;
    at_once_[i++].shared[axis] = lacks;
  }
  correct(count, "joint estimate: AHRS refused");
  i = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (filter_.model().moves(axis)) colour_[static_cast<std::size_t>(axis)].hear(at_once_[i++].score);
  }
}

void JointEstimate::hear(const TagPose& sample) {
  const auto camera = places_.cameras.find(sample.camera);
  const auto tag = places_.tags.find(sample.tag);
  if (!navigator_.tags.used || camera == places_.cameras.end() || tag == places_.tags.end()) return;
  wait({.utime = sample.utime,
        .kind = Kind::kTag,
        .a = tag->second,
        .b = camera->second.p_BC + camera->second.R_BC * sample.p_CT});
}

void JointEstimate::hear(const OpticalFlow& sample) {
  const auto camera = places_.cameras.find(sample.camera);
  if (!navigator_.flow.used || camera == places_.cameras.end()) return;
  wait({.utime = sample.utime,
        .kind = Kind::kFlow,
        .a = sample.flow_C,
        .b = sample.covariance.diagonal(),
        .camera = &camera->second});
}

void JointEstimate::hear(const LaserRange& sample) {
  const auto camera = places_.cameras.find(sample.camera);
  if (!navigator_.laser.used || camera == places_.cameras.end()) return;
  wait({.utime = sample.utime,
        .kind = Kind::kLaser,
        .a = sample.p_CL,
        .sigma = sample.sigma_range,
        .camera = &camera->second});
}

void JointEstimate::hear(const Dvl& sample) {
  if (!navigator_.dvl.used || !sample.valid || sample.held) return;
  wait({.utime = sample.utime, .kind = Kind::kDvl, .a = sample.v_WB_B});
}

void JointEstimate::hear(const Usbl& sample) {
  if (!navigator_.usbl.used || !sample.valid) return;
  wait({.utime = sample.utime, .kind = Kind::kUsbl, .a = sample.p_WB, .b = sample.sigma});
}

void JointEstimate::hear(const Depth& sample) {
  if (!navigator_.depth.used) return;
  wait({.utime = sample.utime, .kind = Kind::kDepth, .a = {0.0, 0.0, sample.z}});
}

}  // namespace fathom::joint
