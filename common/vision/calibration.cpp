#include "common/vision/calibration.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/base/error.hpp"
#include "common/vision/lens_equations.hpp"
#include "common/vision/survey_start.hpp"
#include "common/vision/tag_locator.hpp"

namespace fathom::vision {
namespace {

using Block = std::array<double, 6>;  // rotation vector, position

struct Corner {
  const model::Lens& lens;
  Eigen::Vector2d pixel;
  Eigen::Vector3d p_T;
  double sigma;

  template <class T>
  bool operator()(const T* f, const T* k, const T* X_CW, const T* X_WT, T* residual) const {
    const T corner[3] = {T{p_T.x()}, T{p_T.y()}, T{p_T.z()}};
    T p_W[3], p_C[3];
    ceres::AngleAxisRotatePoint(X_WT, corner, p_W);
    for (int i = 0; i < 3; ++i) p_W[i] += X_WT[3 + i];
    ceres::AngleAxisRotatePoint(X_CW, p_W, p_C);
    for (int i = 0; i < 3; ++i) p_C[i] += X_CW[3 + i];
    if (p_C[2] < T{1e-3}) return false;
    const Eigen::Matrix<T, 2, 1> seen = projected<T>(lens, f, k, Eigen::Matrix<T, 3, 1>{p_C[0], p_C[1], p_C[2]});
    residual[0] = (seen.x() - pixel.x()) / sigma;
    residual[1] = (seen.y() - pixel.y()) / sigma;
    return true;
  }
};

/// What was known before, for the six numbers of a tag.
struct Prior {
  Block mean;
  Block sigma;
  template <class T>
  bool operator()(const T* x, T* residual) const {
    for (std::size_t i = 0; i < 6; ++i) residual[i] = (x[i] - mean[i]) / sigma[i];
    return true;
  }
};

struct LensPrior {
  std::array<double, 4> mean, sigma;
  template <class T>
  bool operator()(const T* x, T* residual) const {
    for (std::size_t i = 0; i < 4; ++i) residual[i] = (x[i] - mean[i]) / sigma[i];
    return true;
  }
};

// What is not modelled (a port, a floor that is not flat, a video's coder) is the same in every picture of a sequence,
// and pulls at a focal length by many of its sigmas where all pictures are taken from one height and tilt: there it
// trades against the height and hardly shows. So a given one is left only for something that explains clearly more.
constexpr int kLeastViews = 3;     // of a plane: each leaves two equations for the lens's four numbers (Zhang 2000)
constexpr double kBelieved = 2.0;  // sigmas
constexpr double kWeak = 0.02;     // sigma as a share of the focal length: a lens that was calibrated is known better
constexpr double kEarned = 1.1;    // what is left with the given one, over what is left without

double typical(const Reprojection& error) {
  std::vector<double> left;
  for (const Residual& each : error.residuals) left.push_back(each.error.norm());
  if (left.empty()) return 0.0;
  const auto middle = left.begin() + static_cast<std::ptrdiff_t>(left.size() / 2);
  std::nth_element(left.begin(), middle, left.end());
  return *middle;
}

// Of a tag that the border cuts not all corners can be believed.
std::vector<TagSighting> whole(std::vector<TagSighting> tags) {
  std::erase_if(tags, [](const TagSighting& tag) { return std::ranges::find(tag.sound, false) != tag.sound.end(); });
  return tags;
}

Block block(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  const Eigen::Vector3d turn = rotation_vector_from_quaternion(Eigen::Quaterniond{R});
  return {turn.x(), turn.y(), turn.z(), p.x(), p.y(), p.z()};
}

Eigen::Matrix3d rotation(const Block& b) {
  return quaternion_from_rotation_vector({b[0], b[1], b[2]}).toRotationMatrix();
}

class Adjustment {
 public:
  /// `focal_kept`: it is as given.
  Adjustment(const SurveyStart& start, const std::vector<View>& views, const CalibrationSettings& settings,
             bool focal_kept)
      : site_{start.site},
        surveyed_{start.surveyed},
        lens_{*site_.lens},
        settings_{settings},
        f_{lens_.fx, lens_.fy, lens_.cx, lens_.cy},
        k_{lens_.distortion} {
    for (const model::Tag& tag : site_.tags) tags_[tag.number()] = block(tag.R_WT, tag.p_WT);
    add_corners(views);
    add_priors();
    if (settings.lens && focal_kept) problem_.SetManifold(f_.data(), new ceres::SubsetManifold(4, {0, 1}));
  }

  Calibration solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-10;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    Calibration result;
    result.site = site_;
    model::Lens& lens = *result.site.lens;
    lens.fx = f_[0];
    lens.fy = f_[1];
    lens.cx = f_[2];
    lens.cy = f_[3];
    lens.distortion = k_;
    for (model::Tag& tag : result.site.tags) {
      const Block& b = tags_.at(tag.number());
      tag.R_WT = rotation(b);
      tag.p_WT = {b[3], b[4], b[5]};
    }
    result.converged = summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE;
    result.message = summary.message;
    result.n_corners = n_corners_;
    result.n_views = static_cast<int>(views_.size());
    if (settings_.lens) find_lens_sigma(result);
    return result;
  }

 private:
  void add_corners(const std::vector<View>& views) {
    // Where new tags were only placed one after the other, what fits is seen after the adjustment.
    model::Site rough = site_;
    if (surveyed_.size() < site_.tags.size())
      rough.search.map_sigma = std::max(rough.search.map_sigma, settings_.sizes.largest());
    const Reprojection start = reproject(rough, views);
    std::set<std::size_t> used;
    for (const Residual& each : start.residuals) used.insert(each.view);
    for (const std::size_t v : used) {
      const Pose& pose = start.poses[v];
      views_[v] = block(pose.R_WC.transpose(), -pose.R_WC.transpose() * pose.p_WC);
    }
    for (const Residual& each : start.residuals) {
      const model::Tag* tag = site_.tag(each.tag);
      const double h = 0.5 * tag->size;
      const std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
      auto* cost = new ceres::AutoDiffCostFunction<Corner, 2, 4, 5, 6, 6>(
          new Corner{lens_, each.pixel, corners[each.corner], settings_.corner_sigma});
      problem_.AddResidualBlock(cost, new ceres::HuberLoss(3.0), f_.data(), k_.data(), views_.at(each.view).data(),
                                tags_.at(each.tag).data());
      ++n_corners_;
    }
  }

  void add_priors() {
    if (!problem_.HasParameterBlock(f_.data())) throw InputError("no picture shows tags whose places are known");
    const double focal = settings_.focal_sigma * lens_.focal(), centre = settings_.centre_sigma;
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<LensPrior, 4, 4>(new LensPrior{f_, {focal, focal, centre, centre}}), nullptr,
        f_.data());
    if (!settings_.lens) problem_.SetParameterBlockConstant(f_.data());
    std::vector<int> fixed;
    for (int i = settings_.lens ? settings_.distortion : 0; i < 5; ++i) fixed.push_back(i);
    if (fixed.size() == 5) {
      problem_.SetParameterBlockConstant(k_.data());
    } else if (!fixed.empty()) {
      problem_.SetManifold(k_.data(), new ceres::SubsetManifold(5, fixed));
    }
    for (auto& [number, b] : tags_) {
      if (!problem_.HasParameterBlock(b.data())) continue;
      if (!settings_.map) {
        problem_.SetParameterBlockConstant(b.data());
        continue;
      }
      const double turn = settings_.flat ? settings_.flat_turn : 3.0, up = settings_.flat ? settings_.flat_sigma : 1.0;
      const double across = surveyed(number) ? settings_.map_sigma : 10.0;
      const double height = surveyed(number) ? std::min(up, settings_.map_sigma) : up;
      const Block sigma{turn, turn, surveyed(number) ? 0.1 : 10.0, across, across, height};
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<Prior, 6, 6>(new Prior{b, sigma}), nullptr, b.data());
      const bool origin = surveyed_.empty() && number == site_.tags.front().number();
      if (origin) problem_.SetParameterBlockConstant(b.data());
    }
  }

  [[nodiscard]] bool surveyed(int number) const {
    return std::find(surveyed_.begin(), surveyed_.end(), number) != surveyed_.end();
  }

  void find_lens_sigma(Calibration& result) {
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    ceres::Covariance covariance{options};
    std::array<double, 16> values{};
    const std::vector<std::pair<const double*, const double*>> blocks{{f_.data(), f_.data()}};
    if (!covariance.Compute(blocks, &problem_)) return;
    if (!covariance.GetCovarianceBlock(f_.data(), f_.data(), values.data())) return;
    for (std::size_t i = 0; i < 4; ++i) result.lens_sigma[i] = std::sqrt(values[5 * i]);
  }

  model::Site site_;
  std::vector<int> surveyed_;
  model::Lens lens_;
  CalibrationSettings settings_;
  std::array<double, 4> f_{};
  std::array<double, 5> k_{};
  std::map<int, Block> tags_;
  std::map<std::size_t, Block> views_;
  int n_corners_{};
  ceres::Problem problem_;
};

}  // namespace

Calibration calibrate(const model::Site& site, const std::vector<View>& pictures, const CalibrationSettings& settings) {
  std::vector<View> views = pictures;
  for (View& view : views) view.tags = whole(std::move(view.tags));
  if (!site.lens) throw InputError("calibration begins with a lens: state 'camera' in the site's file");
  const SurveyStart start = start_survey(site, views, settings.sizes, settings.flat);
  if (start.site.tags.empty()) throw InputError("no tags are known: state 'tags' in the site's file, or --size");
  const auto shown = std::count_if(views.begin(), views.end(), [](const View& view) { return !view.tags.empty(); });
  if (settings.lens && shown < kLeastViews) {
    throw InputError("a lens is told by " + std::to_string(kLeastViews) +
                     " pictures of tags at least, tilted and near and far; there " +
                     (shown == 1 ? "is 1" : "are " + std::to_string(shown)));
  }
  const auto solved = [&](bool focal_kept) {
    Calibration result = Adjustment{start, views, settings, focal_kept}.solve();
    result.after = reproject(result.site, views);
    return result;
  };
  Calibration result = solved(false);
  const double moved = std::abs(result.site.lens->focal() - site.lens->focal());
  const double sigma = result.lens_sigma[0];
  if (settings.lens && settings.given && (moved > kBelieved * sigma || sigma > kWeak * site.lens->focal())) {
    Calibration kept = solved(true);
    if (typical(kept.after) < kEarned * typical(result.after)) {
      kept.undetermined_focal = result.site.lens->focal();
      result = std::move(kept);
    }
  }
  result.before = reproject(start.site, views);
  return result;
}

Reprojection reproject(const model::Site& site, const std::vector<View>& views) {
  Reprojection result;
  TagLocator locator{site, site.lens, {}};
  const Projection projection{*site.lens};
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::vector<TagSighting> tags = whole(views[v].tags);
    locator.reset();
    result.poses.emplace_back();
    const auto fix = locator.step(0, tags, std::nullopt);
    if (!fix) continue;
    result.poses.back() = fix->pose;
    if (fix->n_tags > 1) result.per_view.push_back(fix->rms);
    for (const TagSighting& tag : tags) {
      if (tag.verdict != TagVerdict::kAccepted) continue;
      const auto [p_CT, R_CT] = locator.in_camera(*fix, *tag.mapped);
      const double h = 0.5 * site.tag(*tag.mapped)->size;
      const std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d seen = projection.pixel(p_CT + R_CT * corners[i]);
        result.residuals.push_back({v, *tag.mapped, i, tag.corners[i], seen - tag.corners[i]});
      }
    }
  }
  std::vector<double> sorted = result.per_view;
  std::sort(sorted.begin(), sorted.end());
  if (!sorted.empty()) {
    result.median = sorted[sorted.size() / 2];
    result.high = sorted[sorted.size() * 95 / 100];
  }
  return result;
}

}  // namespace fathom::vision
