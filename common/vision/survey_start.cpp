#include "common/vision/survey_start.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "common/base/spatial.hpp"
#include "common/vision/tag_locator.hpp"

namespace fathom::vision {
namespace {

constexpr int kLeastSightings = 3;  // fewer may be a false tag

// Pose of a tag from one picture whose camera's pose is known: the better of a plane's two.
std::optional<Pose> place(const Projection& projection, const TagSighting& tag, double size, const Pose& camera) {
  const double h = 0.5 * size;
  const std::array<Eigen::Vector3d, 4> corners_of_tag{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
  std::vector<Correspondence> points;
  for (std::size_t i = 0; i < 4; ++i) points.push_back({corners_of_tag[i], tag.corners[i]});
  const std::vector<Pose> seen = planar_poses(projection, points);  // the camera in T
  if (seen.empty()) return {};
  // Of the two the one that lies flatter: tags lie on a floor.
  Pose best;
  double flattest = -2.0;
  for (const Pose& X_TC : seen) {
    const Eigen::Matrix3d R_WT = camera.R_WC * X_TC.R_WC.transpose();
    if (R_WT(2, 2) <= flattest) continue;
    flattest = R_WT(2, 2);
    best = {.p_WC = camera.p_WC - R_WT * X_TC.p_WC, .R_WC = R_WT};
  }
  return best;
}

// Height of the known tags, where all of them lie level and at one.
std::optional<double> level_of(const std::vector<model::Tag>& tags) {
  constexpr double kLevel = 0.9998, kSameHeight = 0.02;  // cosine of a degree; m
  for (const model::Tag& tag : tags) {
    if (tag.R_WT(2, 2) < kLevel || std::abs(tag.p_WT.z() - tags.front().p_WT.z()) > kSameHeight) return {};
  }
  if (tags.empty()) return {};
  return tags.front().p_WT.z();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// Families count alike: of two tags of one id the second gets a number that nobody has.
model::Tag with_number(const model::Site& site, model::Tag tag) {
  constexpr int kStep = 1000;
  for (int number = tag.id; site.tag(number) != nullptr;) tag.own_number = number += kStep;
  return tag;
}

model::Tag new_tag(const model::Site& site, const model::TagName& name, double size) {
  const bool first = model::same_family(name.family, site.search.families.front());
  return with_number(site, {.id = name.id, .size = size, .family = first ? "" : name.family});
}

}  // namespace

SurveyStart start_survey(const model::Site& site, const std::vector<View>& views, const TagSizes& sizes, bool flat) {
  SurveyStart start{.site = site, .surveyed = {}};
  for (const model::Tag& tag : site.tags) start.surveyed.push_back(tag.number());
  if (sizes.empty()) return start;
  std::map<model::TagName, int> sightings;
  for (const View& view : views) {
    for (const TagSighting& tag : view.tags) {
      const model::TagName name{tag.family, tag.id};
      if (sizes.of(name)) sightings[name] += tag.margin >= least_margin(tag.family) ? 1 : 0;
    }
  }
  if (start.site.tags.empty() && !sightings.empty()) {
    const auto most = std::max_element(sightings.begin(), sightings.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    start.site.tags.push_back(new_tag(start.site, most->first, *sizes.of(most->first)));
  }
  const std::optional<double> level = flat ? level_of(start.site.tags) : std::nullopt;
  // Each round places the tags that were seen together with known ones.
  const Projection projection{*site.lens};
  for (bool more = true; more;) {
    more = false;
    std::map<model::TagName, std::vector<Pose>> placed;
    TagLocator locator{start.site, site.lens, {}};
    for (const View& view : views) {
      std::vector<TagSighting> tags = view.tags;
      locator.reset();
      const auto fix = locator.step(0, tags, std::nullopt);
      if (!fix) continue;
      for (const TagSighting& tag : tags) {
        const model::TagName name{tag.family, tag.id};
        if (tag.verdict != TagVerdict::kOutsideMap || sightings[name] < kLeastSightings) continue;
        if (const auto pose = place(projection, tag, *sizes.of(name), fix->pose)) placed[name].push_back(*pose);
      }
    }
    for (const auto& [name, poses] : placed) {
      if (static_cast<int>(poses.size()) < kLeastSightings) continue;
      model::Tag tag = new_tag(start.site, name, *sizes.of(name));
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Pose& each : poses) values.push_back(each.p_WC[axis]);
        tag.p_WT[axis] = median(values);
      }
      tag.R_WT = poses[poses.size() / 2].R_WC;
      // One tag's tilt is known to some degrees only: told by it, its neighbours would hang in the water.
      if (level) {
        tag.p_WT.z() = *level;
        tag.R_WT = rotation_from_euler({0.0, 0.0, std::atan2(tag.R_WT(1, 0), tag.R_WT(0, 0))});
      }
      start.site.tags.push_back(tag);
      more = true;
    }
  }
  return start;
}

}  // namespace fathom::vision
