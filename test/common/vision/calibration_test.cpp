// Bundle adjustment on corners made by the equations, with noise: what went in comes out.
#include "common/vision/calibration.hpp"

#include <doctest/doctest.h>

#include <random>

#include "common/base/error.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr double kNoise = 0.2;  // px

/// `variety`: of tilts [rad], and of heights.
std::vector<View> views_of(const model::Site& truth, const model::Lens& lens, int n, double variety = 0.4) {
  std::mt19937 random{7};
  std::normal_distribution<double> noise{0.0, kNoise};
  const Projection projection{lens};
  std::vector<View> views;
  for (int i = 0; i < n; ++i) {
    // Turned and tilted, from near and far: what makes the focal length visible.
    const Pose at = pose({0.3 * std::sin(i), 0.3 * std::cos(1.7 * i), 0.1 + 0.1 * variety * (i % 15)},
                         variety * std::sin(2.1 * i), variety * std::cos(1.3 * i), 0.7 * i);
    View view{.name = std::to_string(i)};
    for (const model::Tag& tag : truth.tags) {
      const double h = 0.5 * tag.size;
      const std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
      TagSighting seen{.family = "tag36h11", .id = tag.id, .margin = 60.0};
      bool whole = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector3d p_C = at.R_WC.transpose() * (tag.p_WT + tag.R_WT * corners[k] - at.p_WC);
        whole = whole && p_C.z() > 0.1 && projection.inside(projection.pixel(p_C), 5.0);
        if (!whole) break;
        seen.corners[k] = projection.pixel(p_C) + Eigen::Vector2d{noise(random), noise(random)};
      }
      if (!whole) continue;
      seen.edge = (seen.corners[1] - seen.corners[0]).norm();
      view.tags.push_back(seen);
    }
    views.push_back(view);
  }
  return views;
}

}  // namespace

TEST_CASE("calibration: a board gives the lens back") {
  model::Lens truth = lens();
  truth.fx = 560;
  truth.fy = 555;
  truth.cx = 330;
  truth.distortion = {-0.2, 0.05, 0.0, 0.0, 0.0};
  model::Site board = site();
  board.search.map_sigma = 3e-3;
  const std::vector<View> views = views_of(board, truth, 40);
  board.lens = lens();
  const Calibration found = calibrate(board, views, {.map = false});
  CHECK(found.converged);
  const model::Lens& l = *found.site.lens;
  CHECK(std::abs(l.fx - truth.fx) < 4.0 * found.lens_sigma[0] + 0.3);
  CHECK(std::abs(l.fy - truth.fy) < 4.0 * found.lens_sigma[1] + 0.3);
  CHECK(std::abs(l.cx - truth.cx) < 4.0 * found.lens_sigma[2] + 0.3);
  CHECK(l.distortion[0] == doctest::Approx(-0.2).epsilon(0.05));
  CHECK(found.after.median < 1.5 * kNoise * std::sqrt(2.0));
  CHECK(found.after.median < 0.3 * found.before.median);
}

TEST_CASE("calibration: a survey from nothing but the size finds where the tags lie to each other") {
  const model::Site truth = site();
  const std::vector<View> views = views_of(truth, lens(), 40);
  model::Site blank;
  blank.lens = lens();
  blank.search = truth.search;
  const Calibration found = calibrate(blank, views, {.lens = false, .sizes = TagSizes{0.15}});
  CHECK(found.converged);
  REQUIRE(found.site.tags.size() >= 20);
  CHECK(found.site.tags.front().p_WT.norm() == 0.0);  // the origin stays where it is, and level
  CHECK(found.site.tags.front().R_WT.isApprox(Eigen::Matrix3d::Identity()));
  for (const model::Tag& a : found.site.tags) {
    for (const model::Tag& b : found.site.tags) {
      const double wanted = (truth.tag(a.id)->p_WT - truth.tag(b.id)->p_WT).norm();
      CHECK(std::abs((a.p_WT - b.p_WT).norm() - wanted) < 8e-3);  // m: a chain of tags over 2 m, 0.2 px at 1 m
    }
  }
}

TEST_CASE("calibration: a focal length that the pictures cannot tell stays as given, one that they can is found") {
  // One height and nearly one tilt, and a lens that two coefficients do not describe.
  model::Lens truth = lens();
  truth.fx = truth.fy = 1100;
  truth.distortion = {0.5, -1.0, 0.01, -0.01, 30.0};
  model::Site floor = site();
  for (model::Tag& tag : floor.tags) {  // several in a narrow view
    tag.size *= 0.4;
    tag.p_WT.head<2>() *= 0.4;
  }
  std::vector<View> views;
  for (const View& view : views_of(floor, truth, 60, 0.05)) {
    if (view.tags.size() > 1) views.push_back(view);
  }
  REQUIRE(views.size() > 20);
  floor.lens = truth;
  floor.lens->distortion = {};
  const Calibration kept = calibrate(floor, views, {.map_sigma = 0.01});
  REQUIRE(kept.undetermined_focal);
  CHECK(std::abs(*kept.undetermined_focal / truth.fx - 1.0) > 0.01);
  CHECK(kept.site.lens->fx == truth.fx);
  CHECK(kept.site.lens->distortion[0] != 0.0);
  CHECK(kept.after.median < 0.5 * kept.before.median);
  // No more than a beginning: then it is what fits best.
  CHECK_FALSE(calibrate(floor, views, {.map_sigma = 0.01, .given = false}).undetermined_focal);

  const model::Lens other = lens();
  floor.lens->fx = floor.lens->fy = 0.92 * other.fx;
  const Calibration found = calibrate(floor, views_of(floor, other, 40), {.map_sigma = 0.01});
  CHECK_FALSE(found.undetermined_focal);
  CHECK(found.site.lens->fx == doctest::Approx(other.fx).epsilon(0.01));
}

TEST_CASE("calibration: nothing to go by is said") {
  model::Site blank;
  CHECK_THROWS_AS(static_cast<void>(calibrate(blank, {}, {})), InputError);
  blank.lens = lens();
  CHECK_THROWS_AS(static_cast<void>(calibrate(blank, {}, {})), InputError);
  CHECK_THROWS_AS(static_cast<void>(calibrate(blank, {View{}}, {.sizes = TagSizes{0.1}})), InputError);
}

}  // namespace fathom::vision
