#include "common/vision/tag_locator.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr double kSteady = 0.3;  // m: what a lone tag's pose may err
constexpr int kOutvoted = 5;     // lone tags in a row that contradict the memory: the memory is wrong

std::array<Eigen::Vector3d, 4> world_corners(const model::Tag& tag) {
  const double h = 0.5 * tag.size;
  const std::array<Eigen::Vector3d, 4> own{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
  std::array<Eigen::Vector3d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = tag.p_WT + tag.R_WT * own[i];
  return corners;
}

}  // namespace

TagLocator::TagLocator(const model::Site& site, const std::optional<model::Lens>& lens, const LocatorSettings& settings)
    : site_{site}, settings_{settings} {
  if (!lens) return;
  projection_.emplace(*lens);
  folds_ = projection_->folds();
}

void TagLocator::reset() {
  last_.reset();
  implausible_ = 0;
}

double TagLocator::since_last(const Pose& pose) const { return (pose.p_WC - last_->p_WC).norm(); }

bool TagLocator::recent(Utime utime) const {
  return last_ && utime >= last_utime_ && seconds_between(last_utime_, utime) <= settings_.memory;
}

void TagLocator::judge_by_map(std::vector<TagSighting>& tags) {
  candidates_.clear();
  for (TagSighting& tag : tags) {
    tag.reprojection = -1.0;
    tag.mapped.reset();
    const bool clear = tag.margin >= site_.search.least_margin.value_or(least_margin(tag.family));
    const bool doubtful = std::any_of(
        site_.doubtful_tags.begin(), site_.doubtful_tags.end(),
        [&](const model::TagName& each) { return each.id == tag.id && model::same_family(each.family, tag.family); });
    const model::Tag* known = site_.tag(tag.family, tag.id);
    if (known != nullptr) tag.mapped = known->number();
    if (doubtful) {
      tag.verdict = TagVerdict::kDoubtful;
    } else if (known == nullptr && !site_.tags.empty()) {
      tag.verdict = TagVerdict::kOutsideMap;
    } else if (known == nullptr || !projection_) {
      tag.verdict = clear ? TagVerdict::kAccepted : TagVerdict::kLowMargin;
    } else {
      Candidate candidate{.tag = &tag, .normal = known->R_WT.col(2), .clear = clear};
      const auto corners = world_corners(*known);
      for (std::size_t i = 0; i < 4; ++i) {
        if (tag.sound[i] && (!folds_ || projection_->sees(tag.corners[i])))
          candidate.corners.push_back({corners[i], tag.corners[i]});
      }
      tag.verdict = TagVerdict::kCut;
      if (candidate.corners.empty()) continue;
      candidates_.push_back(std::move(candidate));
    }
  }
}

double TagLocator::error(const Candidate& candidate, const Pose& pose) const {
  double squares = 0.0;
  for (const Correspondence& each : candidate.corners) {
    const Eigen::Vector3d p_C = pose.R_WC.transpose() * (each.p_W - pose.p_WC);
    if (!(p_C.z() > 1e-3)) return 1e9;
    squares += (projection_->pixel(p_C) - each.pixel).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(candidate.corners.size()));
}

double TagLocator::gate(const Candidate& candidate, const Pose& pose) const {
  const double distance = (candidate.corners.front().p_W - pose.p_WC).norm();
  const double by_map = projection_->lens().focal() * site_.search.map_sigma / std::max(distance, 1e-3);
  const double sigma = std::sqrt(2.0) * std::hypot(settings_.corner_sigma, by_map);
  return std::min(settings_.gate * sigma, 0.4 * candidate.tag->edge);
}

std::vector<Correspondence> TagLocator::corners_of(const std::vector<bool>& chosen) const {
  std::vector<Correspondence> points;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (chosen[i]) points.insert(points.end(), candidates_[i].corners.begin(), candidates_[i].corners.end());
  }
  return points;
}

// Which tags a pose explains, to within a limit [edges of each tag] or its gate. Of two that are printed alike the
// nearer counts.
void TagLocator::choose(double limit, Consensus& consensus) const {
  const Pose& pose = consensus.fitted.pose;
  consensus.agrees.assign(candidates_.size(), false);
  consensus.n = 0;
  consensus.margin = 0.0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& tag = candidates_[i];
    const double e = error(tag, pose);
    if (e > std::max(gate(tag, pose), limit * tag.tag->edge)) continue;
    const bool rival = std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& each) {
      return each.tag != tag.tag && each.tag->mapped == tag.tag->mapped && error(each, pose) < e;
    });
    if (rival) continue;
    consensus.agrees[i] = true;
    ++consensus.n;
    consensus.margin += tag.tag->margin;
  }
}

// From a pose that explains one tag to the largest set of tags that one pose explains: first roughly, since the tilt of
// one small tag says little of the next one's place, then within the gate. The limit falls step by step: a tag that is
// not where the map has it draws the pose towards itself, and within the gate of such a pose there may be none at all.
std::optional<TagLocator::Consensus> TagLocator::grow(const Pose& seed) const {
  constexpr double kRoughest = 1.0, kFall = 0.6, kFinest = 0.02;  // edges
  Consensus found;
  found.fitted.pose = seed;
  const auto fit = [&](double scale) {
    const std::vector<Correspondence> points = corners_of(found.agrees);
    if (points.size() < 4) return false;
    const auto fitted = fit_pose(*projection_, points, found.fitted.pose, scale);
    if (fitted) found.fitted = *fitted;
    return fitted.has_value();
  };
  for (double limit = kRoughest; limit > kFinest; limit *= kFall) {
    choose(limit, found);
    if (!fit(0.0)) return {};
    const std::vector<bool> rough = found.agrees;
    choose(0.0, found);
    if (found.agrees == rough) break;  // nothing draws it aside
  }
  for (int again = 0; again < 2; ++again) {
    choose(0.0, found);
    if (!fit(3.0 * settings_.corner_sigma)) return {};
  }
  return found;
}

std::optional<TagLocator::Consensus> TagLocator::best_consensus(Utime utime) const {
  std::optional<Consensus> best;
  const auto try_seed = [&](const Pose& seed) {
    const auto found = grow(seed);
    if (!found) return;
    bool better = !best || found->n > best->n;
    if (best && found->n == best->n) {
      // As many say otherwise: believed is who is nearer to where the camera was, else who is clearer.
      if (found->agrees == best->agrees) {
        better = found->fitted.rms < best->fitted.rms - 1e-9;
      } else if (recent(utime)) {
        better = since_last(found->fitted.pose) < since_last(best->fitted.pose);
      } else {
        better = found->margin > best->margin;
      }
    }
    if (better) best = found;
  };
  const auto complete = [&] { return best && best->n == static_cast<int>(candidates_.size()); };
  if (recent(utime)) try_seed(*last_);
  if (complete() && best->n > 1) return best;
  for (const Candidate& each : candidates_) {
    for (const Pose& pose : planar_poses(*projection_, each.corners)) try_seed(pose);
    if (complete() && best->n > 2) return best;
  }
  return best;
}

bool TagLocator::alone_is_plausible(Utime utime, const Pose& pose, const std::optional<Eigen::Vector3d>& down_C) {
  constexpr double kWrongSideUp = 0.45;  // rad
  bool plausible = true;
  if (recent(utime)) {
    const double reach = kSteady + settings_.largest_speed * seconds_between(last_utime_, utime);
    plausible = since_last(pose) < reach;
  }
  if (down_C) plausible = plausible && std::acos(std::clamp(down_C->dot(pose.R_WC.row(2)), -1.0, 1.0)) < kWrongSideUp;
  implausible_ = plausible ? 0 : implausible_ + 1;
  return plausible || (implausible_ > kOutvoted && !down_C);
}

// A plane's second pose: its normal mirrored at the line of sight. Both explain the corners when the picture's
// perspective is smaller than the corners' error. Gravity, or a pose known just before, decides where it can.
void TagLocator::look_for_second(Utime utime, const std::vector<Correspondence>& points, const Eigen::Vector3d& normal,
                                 const std::optional<Eigen::Vector3d>& down_C, FittedPose& fitted,
                                 CameraFix& fix) const {
  constexpr double kSame = 0.035;    // rad: nearer than that they are one
  constexpr double kDecided = 16.0;  // difference of squared errors in variances: odds of 3000 to 1
  const double dof = std::max(2.0 * static_cast<double>(points.size()) - 6.0, 1.0);
  const double scale = 3.0 * settings_.corner_sigma;
  const auto second = fit_pose(*projection_, points, mirrored(fitted.pose, points, normal), scale);
  if (!second) return;
  const auto tilt = [](const Pose& a, const Eigen::Vector3d& down) {
    return std::acos(std::clamp(down.dot(a.R_WC.row(2)), -1.0, 1.0));
  };
  const Eigen::Vector3d first_down = fitted.pose.R_WC.row(2);
  if (tilt(second->pose, first_down) < kSame) return;
  const double variance =
      std::max(settings_.corner_sigma * settings_.corner_sigma, std::min(fitted.cost, second->cost) / dof);
  if (std::abs(second->cost - fitted.cost) > kDecided * variance) {
    if (second->cost < fitted.cost) fitted = *second;
    return;
  }
  std::optional<Eigen::Vector3d> down = down_C;
  double sigma = settings_.attitude_sigma;
  if (!down && recent(utime)) {
    down = last_->R_WC.row(2);
    sigma += seconds_between(last_utime_, utime) * 0.5;  // rad/s that the camera may have tilted with
  }
  if (down) {
    const double one = tilt(fitted.pose, *down), two = tilt(second->pose, *down);
    if (std::abs(one - two) > 2.0 * sigma) {
      if (two < one) fitted = *second;
      return;
    }
  }
  fix.ambiguous = true;
  fix.other = second->pose;
  if (second->cost < fitted.cost) {
    fix.other = fitted.pose;
    fitted = *second;
  }
}

// What corners err is stated beforehand and seen in the fit, a lone tag's too: the larger counts, since lens and light
// move all of them alike. One tag's shift in the map is the camera's, and no fit shows it.
Matrix6d TagLocator::covariance(const FittedPose& fitted, std::size_t n_points, int n_tags) const {
  const double dof = 2.0 * static_cast<double>(n_points) - 6.0;
  const double squares = fitted.rms * fitted.rms * static_cast<double>(n_points);
  const double variance = std::max(settings_.corner_sigma * settings_.corner_sigma, squares / dof);
  Matrix6d result = variance * fitted.information.inverse();
  result.topLeftCorner<3, 3>().diagonal().array() += site_.search.map_sigma * site_.search.map_sigma / n_tags;
  return result;
}

std::optional<CameraFix> TagLocator::step(Utime utime, std::vector<TagSighting>& tags,
                                          const std::optional<Eigen::Vector3d>& down_C) {
  judge_by_map(tags);
  if (candidates_.empty()) return {};
  auto best = best_consensus(utime);
  for (Candidate& each : candidates_) {
    each.tag->verdict = each.corners.size() < 4 ? TagVerdict::kCut
                        : each.clear            ? TagVerdict::kGeometry
                                                : TagVerdict::kLowMargin;
    if (best) each.tag->reprojection = error(each, best->fitted.pose);
  }
  if (!best) return {};
  const std::size_t n = candidates_.size();
  const auto first =
      static_cast<std::size_t>(std::find(best->agrees.begin(), best->agrees.end(), true) - best->agrees.begin());
  if (best->n == 1) {
    const auto clear = std::count_if(candidates_.begin(), candidates_.end(), [](const auto& c) { return c.clear; });
    if (!candidates_[first].clear && !recent(utime)) return {};
    if (clear > 1 && (!recent(utime) || since_last(best->fitted.pose) > kSteady)) {
      for (Candidate& each : candidates_) {
        if (each.clear) each.tag->verdict = TagVerdict::kDisagree;
      }
      return {};
    }
  }
  CameraFix fix;
  const std::vector<Correspondence> points = corners_of(best->agrees);
  look_for_second(utime, points, candidates_[first].normal, down_C, best->fitted, fix);
  if (best->n == 1 && !alone_is_plausible(utime, best->fitted.pose, down_C)) {
    candidates_[first].tag->verdict = TagVerdict::kImplausible;
    return {};
  }
  for (std::size_t i = 0; i < n; ++i) {
    Candidate& each = candidates_[i];
    each.tag->reprojection = error(each, best->fitted.pose);
    if (best->agrees[i]) {
      each.tag->verdict = TagVerdict::kAccepted;
      continue;
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (best->agrees[k] && candidates_[k].tag->mapped == each.tag->mapped) each.tag->verdict = TagVerdict::kTwice;
    }
  }
  fix.pose = best->fitted.pose;
  fix.rms = best->fitted.rms;
  fix.n_tags = best->n;
  fix.covariance = covariance(best->fitted, points.size(), best->n);
  if (!fix.covariance.allFinite()) return {};
  if (!fix.ambiguous) {
    last_ = fix.pose;
    last_utime_ = utime;
  }
  return fix;
}

std::vector<TagLocator::Expected> TagLocator::missing(const CameraFix& fix,
                                                      const std::vector<TagSighting>& seen) const {
  constexpr double kBorder = -5.0, kSteepest = 0.3;  // px: the prediction errs, at the picture's edge too
  std::vector<Expected> result;
  for (const model::Tag& tag : site_.tags) {
    const bool known =
        std::any_of(seen.begin(), seen.end(), [&](const TagSighting& each) { return each.mapped == tag.number(); });
    const Eigen::Vector3d to = tag.p_WT - fix.pose.p_WC;
    if (known || to.dot(tag.R_WT.col(2)) < kSteepest * to.norm()) continue;
    std::array<Eigen::Vector2d, 4> corners;
    bool whole = true;
    const auto points = world_corners(tag);
    for (std::size_t i = 0; i < 4 && whole; ++i) {
      const Eigen::Vector3d p_C = fix.pose.R_WC.transpose() * (points[i] - fix.pose.p_WC);
      whole = p_C.z() > 1e-2;
      if (!whole) break;
      corners[i] = projection_->pixel(p_C);
      whole = projection_->inside(corners[i], kBorder);
    }
    if (whole) result.push_back({{site_.family_of(tag), tag.id}, corners});
  }
  return result;
}

std::pair<Eigen::Vector3d, Eigen::Matrix3d> TagLocator::in_camera(const CameraFix& fix, int number) const {
  const model::Tag& tag = *site_.tag(number);
  return {fix.pose.R_WC.transpose() * (tag.p_WT - fix.pose.p_WC), fix.pose.R_WC.transpose() * tag.R_WT};
}

}  // namespace fathom::vision
