#include "common/vision/optical_flow.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "common/base/spatial.hpp"
#include "common/vision/light_change.hpp"
#include "common/vision/plane_flow.hpp"

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
    case FlowState::kNoRotation:
      return "rotation unknown";
  }
  return "";
}

struct FlowTracker::State {
  static constexpr int kLevels = 3;
  Projection projection;
  FlowSettings settings;
  std::optional<Utime> before;
  std::vector<cv::Mat> pyramid_before, pyramid;
  cv::Mat small, mask;                     // mask: empty, or 0 where there are no features
  cv::Mat blurred, smooth, smooth_before;  // the last two in float
  std::vector<cv::Point2f> features, found, back;
  std::vector<unsigned char> ok, ok_back;
  std::vector<float> errors;
  std::vector<Track> tracks;
  std::vector<FlowRow> rows;

  State(const model::Lens& lens, const FlowSettings& s) : projection{lens}, settings{s} {
    if (projection.folds()) leave_out_folded();
  }

  [[nodiscard]] cv::Size reduced_size() const {
    const model::Lens& lens = projection.lens();
    return {cvRound(lens.width / settings.reduction), cvRound(lens.height / settings.reduction)};  // as cv::resize
  }
  // No features where the lens says no direction.
  void leave_out_folded() {
    mask = cv::Mat(reduced_size(), CV_8UC1, cv::Scalar{255});
    for (int y = 0; y < mask.rows; ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        const cv::Point2f p{static_cast<float>(x), static_cast<float>(y)};
        if (!projection.sees(whole(p))) mask.at<std::uint8_t>(y, x) = 0;
      }
    }
  }

  [[nodiscard]] cv::Size window() const {
    const int side = settings.reduction > 1.5 ? 15 : 21;
    return {side, side};
  }

  // Pixels of the reduced picture and of the whole one: pixels' middles are whole numbers in both.
  [[nodiscard]] Eigen::Vector2d whole(const cv::Point2f& p) const {
    const double r = settings.reduction;
    return {(static_cast<double>(p.x) + 0.5) * r - 0.5, (static_cast<double>(p.y) + 0.5) * r - 0.5};
  }
  [[nodiscard]] cv::Point2f reduced(const Eigen::Vector2d& p) const {
    const double r = settings.reduction;
    return {static_cast<float>((p.x() + 0.5) / r - 0.5), static_cast<float>((p.y() + 0.5) / r - 0.5)};
  }

  void look(const cv::Mat& grey) {
    if (settings.reduction > 1.0) {
      cv::resize(grey, small, {}, 1.0 / settings.reduction, 1.0 / settings.reduction, cv::INTER_AREA);
    } else {
      grey.copyTo(small);
    }
    cv::buildOpticalFlowPyramid(small, pyramid, window(), kLevels);
    // Mean values of pixels still hold detail finer than the reduced ones can: interpolated, it draws each feature to
    // whole pixels, and motion of less than one, as a divergence is, was read too small. Tracks' ends are fitted in
    // smoother pictures; not found in them, for moving light is smooth too.
    constexpr double kSmooth = 1.0;  // px, reduced
    std::swap(smooth, smooth_before);
    cv::GaussianBlur(small, blurred, {5, 5}, kSmooth);
    blurred.convertTo(smooth, CV_32F);
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
      if (!R_01) {
        found.push_back(each);
        continue;
      }
      const Eigen::Vector2d x = projection.normalized(whole(each));
      const Eigen::Vector3d turned = R_01->transpose() * Eigen::Vector3d{x.x(), x.y(), 1.0};
      found.push_back(turned.z() > 0.1 ? reduced(projection.pixel(turned)) : each);
    }
    const cv::TermCriteria stop{cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 15, 0.01};
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
      const cv::Point2f end = end_in_changed_light(smooth_before, smooth, features[i], found[i]).value_or(found[i]);
      tracks.push_back({.from = whole(features[i]), .to = whole(end)});
    }
  }

  // Each track with the rotation taken out, and its inverse depth against the axis's.
  void make_rows(const Eigen::Matrix3d& R_01, const Eigen::Vector3d& normal_0) {
    rows.clear();
    for (const Track& each : tracks) {
      const Eigen::Vector2d x = projection.normalized(each.from), x1 = projection.normalized(each.to);
      const Eigen::Vector3d turned = R_01 * Eigen::Vector3d{x1.x(), x1.y(), 1.0};
      const Eigen::Vector2d y = turned.head<2>() / turned.z();
      const double s = normal_0.dot(Eigen::Vector3d{x.x(), x.y(), 1.0}) / normal_0.z();
      rows.push_back({.d = y - x, .y = y, .s = s});
    }
  }
};

FlowTracker::FlowTracker(const model::Lens& lens, const FlowSettings& settings)
    : state_{std::make_unique<State>(lens, settings)} {}
FlowTracker::~FlowTracker() = default;
FlowTracker::FlowTracker(FlowTracker&&) noexcept = default;
FlowTracker& FlowTracker::operator=(FlowTracker&&) noexcept = default;

const std::vector<Track>& FlowTracker::tracks() const { return state_->tracks; }

void FlowTracker::leave_out(const std::vector<Eigen::Vector2d>& line, double reach) {
  const double r = state_->settings.reduction;
  if (state_->mask.empty()) state_->mask = cv::Mat(state_->reduced_size(), CV_8UC1, cv::Scalar{255});
  for (const Eigen::Vector2d& each : line) {
    cv::circle(state_->mask, state_->reduced(each), static_cast<int>(std::ceil(reach / r)), cv::Scalar{0}, cv::FILLED);
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
      const Eigen::Vector3d normal_1 = normal_C.value_or(Eigen::Vector3d::UnitZ());
      state.make_rows(*R_01, *R_01 * normal_1);
      const PlaneFlow plane = fit_plane_flow(state.rows);
      const double focal = state.projection.lens().focal();
      for (std::size_t i = 0; i < state.tracks.size(); ++i) state.tracks[i].agrees = plane.agrees[i];
      flow.n_agreed = plane.n_agreed;
      flow.residual = plane.spread * focal;
      const Eigen::RowVector3d n_0 = (*R_01 * normal_1 / (*R_01 * normal_1).z()).transpose();
      flow.floor_10 = R_01->transpose() * (Eigen::Matrix3d::Identity() - plane.tau * n_0);
      flow.nearing = 1.0 - n_0.dot(plane.tau);
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
      flow.state = enough && flow.covariance.allFinite() ? FlowState::kValid : FlowState::kDisagree;
    }
  }
  state.choose_features();
  return flow;
}

}  // namespace fathom::vision
