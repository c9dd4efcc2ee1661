#include "common/vision/optical_flow.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "common/base/spatial.hpp"
#include "common/vision/fine_shift.hpp"
#include "common/vision/light_change.hpp"
#include "common/vision/plane_flow.hpp"
#include "common/vision/reduced_view.hpp"
#include "common/vision/steady_pattern.hpp"

namespace fathom::vision {

const char* name(FlowState state) {
  switch (state) {
    case FlowState::kNone:
      return "none";
    case FlowState::kValid:
      return "valid";
    case FlowState::kFirst:
      return "first picture";
    case FlowState::kPause:
      return "pause between pictures";
    case FlowState::kNoTexture:
      return "no texture";
    case FlowState::kLost:
      return "tracks lost";
    case FlowState::kDisagree:
      return "tracks disagree";
    case FlowState::kNoDetail:
      return "no fine detail";
    case FlowState::kNoRotation:
      return "rotation unknown";
  }
  return "";
}

struct FlowTracker::State {
  static constexpr int kLevels = 3;
  ReducedView view;
  FlowSettings settings;
  std::optional<Utime> before;
  std::vector<cv::Mat> pyramid_before, pyramid;
  cv::Mat seen, small;   // as it is, and without what is steady
  cv::Mat mask, weight;  // empty, or 0 where there are no features, and what detail counts
  cv::Mat blurred, smooth, wide, fine, fine_before;  // all but the first in float
  SteadyPattern steady;
  FineShift fine_shift;
  cv::Mat nodes, origin;
  std::vector<cv::Point2f> features, found, back;
  std::vector<unsigned char> ok, ok_back;
  std::vector<float> errors;
  std::vector<Track> tracks;
  std::vector<FlowRow> rows;

  State(const model::Lens& lens, const FlowSettings& s) : view{lens, s.reduction}, settings{s} {
    if (view.projection().folds()) leave_out_folded();
  }

  // No features where the lens says no direction.
  void leave_out_folded() {
    mask = cv::Mat(view.size(), CV_8UC1, cv::Scalar{255});
    for (int y = 0; y < mask.rows; ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        const cv::Point2f p{static_cast<float>(x), static_cast<float>(y)};
        if (!view.projection().sees(view.whole(p))) mask.at<std::uint8_t>(y, x) = 0;
      }
    }
  }

  [[nodiscard]] cv::Size window() const {
    const int side = settings.reduction > 1.5 ? 15 : 21;
    return {side, side};
  }

  void look(const cv::Mat& grey) {
    if (settings.reduction > 1.0) {
      cv::resize(grey, seen, {}, 1.0 / settings.reduction, 1.0 / settings.reduction, cv::INTER_AREA);
    } else {
      grey.copyTo(seen);
    }
    steady.take_out(seen, small);
    cv::buildOpticalFlowPyramid(small, pyramid, window(), kLevels);
    // Mean values of pixels still hold detail finer than the reduced ones can: interpolated, it draws each feature to
    // whole pixels, and motion of less than one, as a divergence is, was read too small. Tracks' ends are fitted in
    // smoother pictures; not found in them, for moving light is smooth too: so what is coarser is taken out.
    constexpr double kSmooth = 1.0, kWide = 2.0;  // px, reduced
    cv::GaussianBlur(small, blurred, {5, 5}, kSmooth);
    blurred.convertTo(smooth, CV_32F);
    cv::GaussianBlur(smooth, wide, {13, 13}, kWide);
    std::swap(fine, fine_before);
    cv::subtract(smooth, wide, fine);
    fine_shift.look(small, weight);
  }

  void choose_features() {
    constexpr double kQuality = 0.005, kLow = 5e-4;  // of the best: tags outshine a floor by far, lamps even more
    constexpr std::size_t kFew = 4;                  // times fewer than wanted
    features.clear();
    const double area = static_cast<double>(small.cols) * small.rows;
    const double apart = 0.6 * std::sqrt(area / settings.most_tracks);
    for (const double quality : {kQuality, kLow}) {
      cv::goodFeaturesToTrack(small, features, settings.most_tracks, quality, apart, mask, 3);
      if (kFew * features.size() >= static_cast<std::size_t>(settings.most_tracks)) break;
    }
  }

  // There with the rotation as a first guess, and back again.
  void track(const std::optional<Eigen::Matrix3d>& R_01) {
    found.clear();
    for (const cv::Point2f& each : features) {
      found.push_back(R_01 ? view.pixel(R_01->transpose() * view.direction(each)).value_or(each) : each);
    }
    const cv::TermCriteria stop{cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 8, 0.03};
    constexpr double kWeakest = 5e-4;
    cv::calcOpticalFlowPyrLK(pyramid_before, pyramid, features, found, ok, errors, window(), kLevels, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW, kWeakest);
    back = features;
    cv::calcOpticalFlowPyrLK(pyramid, pyramid_before, found, back, ok_back, errors, window(), 0, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW, kWeakest);
    tracks.clear();
    const auto limit = static_cast<float>(settings.there_and_back);
    for (std::size_t i = 0; i < features.size(); ++i) {
      const bool inside = found[i].x >= 0 && found[i].y >= 0 && found[i].x <= static_cast<float>(small.cols - 1) &&
                          found[i].y <= static_cast<float>(small.rows - 1);
      if (ok[i] == 0 || ok_back[i] == 0 || !inside) continue;
      const cv::Point2f miss = back[i] - features[i];
      if (std::hypot(miss.x, miss.y) > limit) continue;
      tracks.push_back({.from = view.whole(features[i]), .to = view.whole(found[i])});
    }
  }

  // Each track with the rotation taken out, and its inverse depth against the axis's.
  void make_rows(const PlaneMotion& motion) {
    rows.clear();
    for (const Track& each : tracks) {
      const Eigen::Vector2d x = view.projection().normalized(each.from), x1 = view.projection().normalized(each.to);
      const Eigen::Vector3d turned = motion.R_01 * Eigen::Vector3d{x1.x(), x1.y(), 1.0};
      const Eigen::Vector2d y = turned.head<2>() / turned.z();
      rows.push_back({.d = y - x, .y = y, .s = motion.n_0.dot(Eigen::Vector3d{x.x(), x.y(), 1.0})});
    }
  }

  // Corrects what the tracks have said by what the fine detail of the whole picture does; how strongly it said so, 0
  // for not at all.
  double correct(PlaneMotion& motion) {
    constexpr double kOther = 1.0;  // px: tracks that followed something else, whose divergence is of no use either
    constexpr int kRounds = 3;
    constexpr double kNearer = 0.5;  // of the distance, between two pictures: more is no motion but tracks by chance
    if (!(std::abs(motion.n_0.dot(motion.tau)) < kNearer)) motion.tau.setZero();
    for (int round = 0; round < kRounds; ++round) {
      view.map_origin(motion, nodes, origin);
      const std::optional<FineMotion> detail = fine_shift.find(origin, steady.known());
      if (!detail) return 0.0;
      motion.tau.head<2>() -= detail->shift / view.focal();
      if (detail->shift.norm() < kOther) return detail->strength;
      motion.tau.z() = 0.0;
    }
    return 0.0;
  }

  void learn(const PlaneMotion& motion) {
    const Eigen::Vector3d axis = motion.forward(Eigen::Vector3d::UnitZ());
    steady.learn(seen, view.focal() * axis.head<2>() / axis.z());
  }

  // Two readings of one motion: the tracks', which light may pull, and that of all fine detail, which it pulls less but
  // which is less precise by itself, by about one over its strength. Where they differ by more than that, it was light.
  void settle(PlaneFlow& plane, const PlaneMotion& by_detail, double strength) const {
    const double precision = 1.0 / (strength * view.focal());
    const Eigen::Vector2d apart = (by_detail.tau - plane.tau).head<2>();
    constexpr double kChance = 3.0;
    const double chance = kChance * kChance * precision * precision / std::max(apart.squaredNorm(), 1e-30);
    const double share = std::max(1.0 - chance, 0.0);
    plane.tau.head<2>() += share * apart;
    plane.covariance.topLeftCorner<2, 2>() += share * apart * apart.transpose();
    plane.covariance(2, 2) += share * apart.squaredNorm();
    plane.covariance.diagonal().array() += precision * precision;  // a pull so small would not be seen
  }

  // Tracks of all features anew, in the pictures' fine detail, from where the motion has them; how many were tried.
  int refine(const PlaneMotion& motion) {
    tracks.clear();
    int tried = 0;
    for (const cv::Point2f& each : features) {
      const auto there = view.pixel(motion.forward(view.direction(each)));
      if (!there) continue;
      const auto end = end_in_changed_light(fine_before, fine, each, *there);
      if (!end) continue;
      ++tried;
      if (end->near) tracks.push_back({.from = view.whole(each), .to = view.whole(end->at)});
    }
    return tried;
  }
  // Once more where the first round has moved far from where it began: ends are found near it alone.
  PlaneFlow follow(PlaneMotion motion, int& tried) {
    constexpr int kRounds = 2;
    constexpr double kNear = 0.2;  // px
    PlaneFlow plane;
    for (int round = 0; round < kRounds; ++round) {
      tried = refine(motion);
      make_rows(motion);
      plane = fit_plane_flow(rows);
      const double moved = (plane.tau - motion.tau).norm() * view.focal();
      if (plane.n_agreed < settings.least_tracks || moved < kNear) break;
      motion.tau = plane.tau;
    }
    return plane;
  }
};

FlowTracker::FlowTracker(const model::Lens& lens, const FlowSettings& settings)
    : state_{std::make_unique<State>(lens, settings)} {}
FlowTracker::~FlowTracker() = default;
FlowTracker::FlowTracker(FlowTracker&&) noexcept = default;
FlowTracker& FlowTracker::operator=(FlowTracker&&) noexcept = default;

const std::vector<Track>& FlowTracker::tracks() const { return state_->tracks; }

void FlowTracker::leave_out(const std::vector<Eigen::Vector2d>& line, double reach) {
  State& state = *state_;
  const double r = state.settings.reduction;
  const cv::Size size = state.view.size();
  cv::Mat outside(size, CV_8UC1, cv::Scalar{255}), apart;
  for (const Eigen::Vector2d& each : line) {
    cv::circle(outside, state.view.reduced(each), static_cast<int>(std::ceil(reach / r)), cv::Scalar{0}, cv::FILLED);
  }
  cv::distanceTransform(outside, apart, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  // Windows that reach over the dot, as far as smoothing has spread it, see it rest.
  constexpr float kSpread = 5.0F, kFade = 25.0F;  // px, reduced
  const cv::Mat far = apart > kSpread + 0.5F * static_cast<float>(state.window().width);
  if (state.mask.empty()) state.mask = cv::Mat(size, CV_8UC1, cv::Scalar{255});
  cv::bitwise_and(state.mask, far, state.mask);
  // Detail fades out: where it ended all at once, the end itself, which rests, would be detail.
  if (state.weight.empty()) state.weight = cv::Mat(size, CV_32FC1, cv::Scalar{1.0});
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float share = std::clamp((apart.at<float>(y, x) - kSpread) / kFade, 0.0F, 1.0F);
      state.weight.at<float>(y, x) *= share * share * (3.0F - 2.0F * share);
    }
  }
}

void FlowTracker::reset() {
  state_->before.reset();
  state_->tracks.clear();
}

Flow FlowTracker::step(Utime utime, const cv::Mat& grey, const std::optional<Eigen::Matrix3d>& R_01,
                       const std::optional<Eigen::Vector3d>& normal_C,
                       const std::optional<Eigen::Matrix3d>& rotation_covariance) {
  State& state = *state_;
  Flow flow{.utime = utime};
  std::swap(state.pyramid, state.pyramid_before);
  state.look(grey);
  state.tracks.clear();
  const std::optional<Utime> before = state.before;
  state.before = utime;
  const std::size_t n_features = state.features.size();
  if (before) {
    flow.interval = seconds_between(*before, utime);
    flow.utime = *before + (utime - *before) / 2;
  }
  if (!before) {
    flow.state = FlowState::kFirst;
  } else if (!(flow.interval > 0.0) || flow.interval > state.settings.longest_interval) {
    flow.state = FlowState::kPause;
  } else if (static_cast<int>(n_features) < state.settings.least_tracks) {
    flow.state = FlowState::kNoTexture;
  } else {
    state.track(R_01);
    flow.n_tracks = static_cast<int>(state.tracks.size());
    if (flow.n_tracks < state.settings.least_tracks) {
      flow.state = FlowState::kLost;
    } else if (!R_01) {
      flow.state = FlowState::kNoRotation;
    } else {
      const Eigen::Vector3d normal_0 = *R_01 * normal_C.value_or(Eigen::Vector3d::UnitZ());
      PlaneMotion motion{.R_01 = *R_01, .n_0 = normal_0 / normal_0.z()};
      state.make_rows(motion);
      motion.tau = fit_plane_flow(state.rows).tau;
      const double strength = state.correct(motion);
      const bool detailed = strength > 0.0;
      PlaneFlow plane;
      if (detailed) {
        plane = state.follow(motion, flow.n_tracks);
        state.settle(plane, motion, strength);
        state.learn(motion);
      } else {
        state.rows.clear();  // of the first tracks, which nothing confirms
      }
      const double focal = state.view.projection().lens().focal();
      for (std::size_t i = 0; i < plane.agrees.size(); ++i) state.tracks[i].agrees = plane.agrees[i];
      flow.n_agreed = plane.n_agreed;
      flow.residual = plane.spread * focal;
      flow.floor_10 = R_01->transpose() * (Eigen::Matrix3d::Identity() - plane.tau * motion.n_0.transpose());
      flow.nearing = 1.0 - motion.n_0.dot(plane.tau);
      // From the first camera's distance and axes to those in the middle.
      const Eigen::Vector3d half = 0.5 * rotation_vector_from_quaternion(Eigen::Quaterniond{*R_01});
      const Eigen::Matrix3d to_middle = quaternion_from_rotation_vector(half).toRotationMatrix().transpose();
      flow.rate = to_middle * plane.tau / (flow.interval * (1.0 - 0.5 * plane.tau.z()));
      const double turning = state.settings.rotation_sigma * flow.interval;
      const Eigen::Matrix3d turn = rotation_covariance.value_or(turning * turning * Eigen::Matrix3d::Identity());
      const Eigen::Matrix3d by_turn = error_by_rotation(state.rows, plane);
      flow.covariance = (plane.covariance + by_turn * turn * by_turn.transpose()) / (flow.interval * flow.interval);
      const bool enough =
          flow.n_agreed >= state.settings.least_tracks && flow.n_agreed >= state.settings.least_share * flow.n_tracks;
      flow.state = !detailed                               ? FlowState::kNoDetail
                   : enough && flow.covariance.allFinite() ? FlowState::kValid
                                                           : FlowState::kDisagree;
    }
  }
  state.choose_features();
  return flow;
}

}  // namespace fathom::vision
