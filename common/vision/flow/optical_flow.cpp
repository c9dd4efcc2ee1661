#include "common/vision/flow/optical_flow.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/flow/features.hpp"
#include "common/vision/flow/flow_pictures.hpp"
#include "common/vision/flow/light_change.hpp"
#include "common/vision/flow/plane_flow.hpp"
#include "common/vision/flow/reduced_view.hpp"

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
  ReducedView view;
  FlowSettings settings;
  FlowPictures pictures;
  std::optional<Utime> before;
  cv::Mat mask;  // empty, or 0 where there are no features
  cv::Mat nodes, origin;
  Features texture;
  std::vector<cv::Point2f> features, some, found;
  std::vector<unsigned char> ok;
  std::vector<Track> tracks;
  std::vector<FlowRow> rows;

  State(const model::Lens& lens, const FlowSettings& s) : view{lens, s.reduction}, settings{s}, pictures{s.reduction} {
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

  void choose_features() {
    constexpr double kQuality = 0.005, kLow = 5e-4;  // of the best: tags outshine a floor by far, lamps even more
    constexpr std::size_t kFew = 4;                  // times fewer than wanted
    const auto most = static_cast<std::size_t>(settings.most_tracks);
    const double area = static_cast<double>(pictures.small().cols) * pictures.small().rows;
    const double apart = 0.6 * std::sqrt(area / settings.most_tracks);
    texture.look(pictures.small(), mask);
    for (const double quality : {kQuality, kLow}) {
      texture.choose(quality, apart, most, features);
      if (kFew * features.size() >= most) break;
    }
  }

  // There with the rotation as a first guess, and back again. What is found is a first guess itself, of three numbers:
  // every fourth feature is enough for it, unless few of them come back.
  void track(const std::optional<Eigen::Matrix3d>& R_01) {
    constexpr std::size_t kPortions = 4;
    tracks.clear();
    for (std::size_t portion = 0; portion < kPortions; ++portion) {
      some.clear();
      for (std::size_t i = portion; i < features.size(); i += kPortions) some.push_back(features[i]);
      if (!some.empty()) track_some(R_01);
      if (2 * tracks.size() >= some.size() && tracks.size() >= 2 * static_cast<std::size_t>(settings.least_tracks))
        break;
    }
  }

  void track_some(const std::optional<Eigen::Matrix3d>& R_01) {
    found.clear();
    for (const cv::Point2f& each : some) {
      found.push_back(R_01 ? view.pixel(R_01->transpose() * view.direction(each)).value_or(each) : each);
    }
    pictures.follow(some, settings.there_and_back, found, ok);
    for (std::size_t i = 0; i < some.size(); ++i) {
      if (ok[i] != 0) tracks.push_back({.from = view.whole(some[i]), .to = view.whole(found[i])});
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
      view.map_origin(motion, pictures.part(), nodes, origin);
      const std::optional<FineMotion> detail = pictures.find_shift(origin);
      if (!detail) return 0.0;
      motion.tau.head<2>() -= detail->shift / view.focal();
      if (detail->shift.norm() < kOther) return detail->strength;
      motion.tau.z() = 0.0;
    }
    return 0.0;
  }

  void learn(const PlaneMotion& motion) {
    const Eigen::Vector3d axis = motion.forward(Eigen::Vector3d::UnitZ());
    pictures.learn_steady(view.focal() * axis.head<2>() / axis.z());
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
  int refine(const PlaneMotion& motion, const FlowPictures::Pair& detail) {
    tracks.clear();
    int tried = 0;
    for (const cv::Point2f& each : features) {
      const auto there = view.pixel(motion.forward(view.direction(each)));
      if (!there) continue;
      const auto end = end_in_changed_light(detail.before, detail.now, each, *there);
      if (!end) continue;
      ++tried;
      if (end->near) tracks.push_back({.from = view.whole(each), .to = view.whole(end->at)});
    }
    return tried;
  }
  // Once more where a round has moved from where it began: ends are found near it alone, and so a round sees less than
  // the whole of what is left, the less the wider they scatter. Where they lie as chance would have them it sees
  // nothing.
  PlaneFlow follow(PlaneMotion motion, const FlowPictures::Pair& detail, int& tried) {
    constexpr int kRounds = 4;
    constexpr double kNear = 0.1;   // px
    constexpr double kLeast = 0.1;  // of what is left; the covariance is then a hundred times that of the spread
    PlaneFlow plane;
    for (int round = 0; round < kRounds; ++round) {
      tried = refine(motion, detail);
      make_rows(motion);
      plane = fit_plane_flow(rows);
      const double seen = std::max(share_seen_near(plane.spread * view.focal()), kLeast);
      const Eigen::Vector3d moved = (plane.tau - motion.tau) / seen;
      plane.tau = motion.tau + moved;
      plane.covariance /= seen * seen;
      if (plane.n_agreed < settings.least_tracks || moved.norm() * view.focal() < kNear) break;
      motion.tau = plane.tau;
    }
    return plane;
  }

  [[nodiscard]] bool enough(const PlaneFlow& plane, int tried) const {
    return plane.n_agreed >= settings.least_tracks && plane.n_agreed >= settings.least_share * tried;
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
  cv::Mat outside(state.view.size(), CV_8UC1, cv::Scalar{255}), apart;
  for (const Eigen::Vector2d& each : line) {
    cv::circle(outside, state.view.reduced(each), static_cast<int>(std::ceil(reach / r)), cv::Scalar{0}, cv::FILLED);
  }
  cv::distanceTransform(outside, apart, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  if (state.mask.empty()) state.mask = cv::Mat(state.view.size(), CV_8UC1, cv::Scalar{255});
  cv::bitwise_and(state.mask, state.pictures.leave_out(apart), state.mask);
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
  state.pictures.look(grey);
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
        plane = state.follow(motion, state.pictures.fine(), flow.n_tracks);
        if (!state.enough(plane, flow.n_tracks)) {
          plane = state.follow(motion, state.pictures.finer(), flow.n_tracks);
        }
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
      motion.tau = plane.tau;
      flow.rate = motion.turned(0.5).transpose() * plane.tau / (flow.interval * motion.distance(0.5));
      flow.middle_distance = motion.distance(0.5) / motion.distance(1.0);
      const double turning = state.settings.rotation_sigma * flow.interval;
      const Eigen::Matrix3d turn = rotation_covariance.value_or(turning * turning * Eigen::Matrix3d::Identity());
      const Eigen::Matrix3d by_turn = error_by_rotation(state.rows, plane);
      flow.covariance = (plane.covariance + by_turn * turn * by_turn.transpose()) / (flow.interval * flow.interval);
      flow.state = !detailed                                                           ? FlowState::kNoDetail
                   : state.enough(plane, flow.n_tracks) && flow.covariance.allFinite() ? FlowState::kValid
                                                                                       : FlowState::kDisagree;
    }
  }
  state.choose_features();
  return flow;
}

}  // namespace fathom::vision
