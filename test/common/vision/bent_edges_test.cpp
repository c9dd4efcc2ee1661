// Large tags through lenses that bend their edges, tags that are seen at a coarser scale alone, and one that is
// covered.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr double kCorner = 0.3;  // px
constexpr double kBent = 0.6;    // px, by which a straight line through a bent edge misses the corner

model::Site large_tag() {
  model::Site place = site();
  place.tags.assign(1, {.id = 3, .size = 0.3, .p_WT = {0.08, 0.0, 1.5}});
  return place;
}

std::array<Eigen::Vector3d, 4> corners_of(const model::Tag& tag) {
  const double h = 0.5 * tag.size;
  std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
  for (Eigen::Vector3d& each : corners) each = tag.p_WT + tag.R_WT * each;
  return corners;
}

double worst_corner(const TagSighting& seen, const model::Tag& tag, const model::Lens& l, const Pose& truth) {
  double worst = 0.0;
  const auto corners = corners_of(tag);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d there = Projection{l}.pixel(truth.R_WC.transpose() * (corners[i] - truth.p_WC));
    worst = std::max(worst, (there - seen.corners[i]).norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("tags: the corners of a large tag are where its bent edges meet, through every kind of lens") {
  model::Lens barrel = lens(), fisheye = lens(), port = lens();
  barrel.distortion = {-0.25, 0.06, 0.0, 0.0, 0.0};
  fisheye.kind = model::Lens::Kind::kFisheye;
  fisheye.fx = fisheye.fy = 320.0;
  port.fx = port.fy = 360.0;
  port.port = model::FlatPort{.distance = 1e-4, .thickness = 1e-4};  // the renderer neglects its offset
  const model::Site place = large_tag();
  for (const model::Lens& l : {barrel, fisheye, port}) {
    CAPTURE(l.fx);
    const Pose truth = pose({0.0, 0.0, 0.85}, 0.05, -0.1, 0.3);
    Renderer renderer{place, l, std::nullopt, {.caustics = 0.0}, 6};
    const cv::Mat grey = grey_of(renderer.step(0.0, truth));
    const DetectorSettings settings{.decimation = 1.0};
    const auto knowing = TagDetector{settings, l}.step(grey);
    REQUIRE(knowing.size() == 1);
    CHECK(worst_corner(knowing.front(), place.tags.front(), l, truth) < kCorner);
    const auto straight = TagDetector{settings}.step(grey);
    REQUIRE(straight.size() == 1);
    CHECK(worst_corner(straight.front(), place.tags.front(), l, truth) > kBent);
  }
}

TEST_CASE("tags: in a large picture without sharp edges tags are found at a coarser scale") {
  const model::Site place = site();
  Renderer renderer{place, lens(), std::nullopt, {.noise = 1.0}, 7};
  cv::Mat large;
  cv::resize(grey_of(renderer.step(0.0, pose({0.03, -0.02, 0.4}))), large, {}, 5.0, 5.0, cv::INTER_CUBIC);
  cv::GaussianBlur(large, large, {}, 5.0);
  const std::size_t fine = TagDetector{{.decimation = 1.0}}.step(large).size();
  const auto all = TagDetector{{.decimation = 1.0, .coarser = true}}.step(large);
  CHECK(fine < 3);
  REQUIRE(all.size() >= 3);
  for (std::size_t i = 1; i < all.size(); ++i) CHECK(all[i].id != all[i - 1].id);  // each but once
}

TEST_CASE("tags: one tag alone whose corners fit ill is known less, and never better than the map") {
  model::Site place = large_tag();
  place.search.map_sigma = 0.01;
  const Pose truth = pose({0.1, 0.0, 0.3}, 0.1, 0.05, 0.2);
  const auto fixed = [&](double aside) {
    TagSighting seen{.family = "tag36h11", .id = 3, .margin = 60.0};
    const auto corners = corners_of(place.tags.front());
    for (std::size_t i = 0; i < 4; ++i) {
      seen.corners[i] = Projection{lens()}.pixel(truth.R_WC.transpose() * (corners[i] - truth.p_WC));
    }
    seen.corners[2] += Eigen::Vector2d{aside, -aside};  // something lies over it
    seen.edge = (seen.corners[1] - seen.corners[0]).norm();
    std::vector<TagSighting> tags{seen};
    const auto fix = TagLocator{place, lens(), {}}.step(0, tags, std::nullopt);
    REQUIRE(fix);
    return *fix;
  };
  const CameraFix good = fixed(0.0), covered = fixed(4.0);
  for (Eigen::Index i = 0; i < 3; ++i) CHECK(std::sqrt(good.covariance(i, i)) >= place.search.map_sigma);
  Vector6d error;
  error.head<3>() = covered.pose.p_WC - truth.p_WC;
  error.tail<3>() = rotation_vector_from_quaternion(Eigen::Quaterniond{truth.R_WC.transpose() * covered.pose.R_WC});
  CHECK(error.dot(covered.covariance.inverse() * error) < 22.5);  // one in a thousand of six numbers
  CHECK(error.dot(good.covariance.inverse() * error) > 50.0);     // what it was taken for
}

}  // namespace fathom::vision
