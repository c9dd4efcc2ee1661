#include "common/vision/projection.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace fathom::vision {
namespace {

constexpr double kSamePixel = 1e-6;    // px: two programs for one formula
constexpr double kSameRay = 1e-9;      // m: Newton to the last bits
constexpr double kDifferences = 1e-3;  // px/m: derivatives by differences

model::Lens pinhole() {
  model::Lens lens{.width = 640, .height = 480, .fx = 530, .fy = 540, .cx = 310, .cy = 245};
  lens.distortion = {-0.25, 0.09, 1e-3, -2e-3, -0.01};
  return lens;
}

model::Lens fisheye() {
  model::Lens lens{.kind = model::Lens::Kind::kFisheye, .width = 640, .height = 480, .fx = 300, .fy = 302};
  lens.cx = 320;
  lens.cy = 240;
  lens.distortion = {0.02, -0.01, 3e-3, -1e-3, 0};
  return lens;
}

const std::vector<Eigen::Vector3d> kPoints{{0, 0, 1}, {0.3, -0.2, 1.1}, {-0.5, 0.4, 2}, {0.9, 0.7, 1.8}};

}  // namespace

TEST_CASE("projection: pinhole and fisheye are OpenCV's") {
  const auto camera = [](const model::Lens& l) { return cv::Matx33d{l.fx, 0, l.cx, 0, l.fy, l.cy, 0, 0, 1}; };
  for (const Eigen::Vector3d& p : kPoints) {
    const std::vector<cv::Point3d> one{{p.x(), p.y(), p.z()}};
    const cv::Vec3d none{0, 0, 0};
    std::vector<cv::Point2d> theirs;
    const model::Lens a = pinhole(), b = fisheye();
    cv::projectPoints(one, none, none, camera(a), a.distortion, theirs);
    CHECK((Projection{a}.pixel(p) - Eigen::Vector2d{theirs[0].x, theirs[0].y}).norm() < kSamePixel);
    const cv::Vec4d k{b.distortion[0], b.distortion[1], b.distortion[2], b.distortion[3]};
    cv::fisheye::projectPoints(one, theirs, none, none, camera(b), k);
    CHECK((Projection{b}.pixel(p) - Eigen::Vector2d{theirs[0].x, theirs[0].y}).norm() < kSamePixel);
  }
}

TEST_CASE("projection: the ray of a point's pixel goes through the point, with and without a port") {
  model::Lens behind = pinhole();
  behind.port = model::FlatPort{.distance = 0.02, .thickness = 0.006};
  for (const model::Lens& lens : {pinhole(), fisheye(), behind}) {
    const Projection projection{lens};
    for (const Eigen::Vector3d& p : kPoints) {
      if (!projection.inside(projection.pixel(p))) continue;
      const Ray ray = projection.ray(projection.pixel(p));
      CHECK(ray.direction.cross(p - ray.origin).norm() < kSameRay);
    }
  }
}

TEST_CASE("projection: a port bends by Snell's law") {
  // By hand: in air 30 deg, through 5 mm of acrylic, into water; the lens sits 20 mm behind.
  model::Lens lens{.width = 2000, .height = 2000, .fx = 500, .fy = 500, .cx = 999.5, .cy = 999.5};
  lens.port = model::FlatPort{.distance = 0.02, .thickness = 0.005, .index_window = 1.5, .index_water = 1.333};
  const double air = 30.0 / 180.0 * M_PI;
  const double window = std::asin(std::sin(air) / 1.5), water = std::asin(std::sin(air) / 1.333);
  const double depth = 1.7;
  const double r = 0.02 * std::tan(air) + 0.005 * std::tan(window) + depth * std::tan(water);
  const Eigen::Vector2d seen = Projection{lens}.pixel({r, 0.0, 0.025 + depth});
  CHECK(seen.x() == doctest::Approx(999.5 + 500 * std::tan(air)).epsilon(1e-12));
  CHECK(seen.y() == doctest::Approx(999.5));
}

TEST_CASE("projection: water before the port magnifies by its index") {
  model::Lens lens{.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 319.5, .cy = 239.5};
  const Eigen::Vector3d p{0.01, 0.0, 2.0};
  const double plain = Projection{lens}.pixel(p).x() - lens.cx;
  lens.port = model::FlatPort{};
  CHECK((Projection{lens}.pixel(p).x() - lens.cx) / plain == doctest::Approx(1.333).epsilon(1e-4));
}

TEST_CASE("projection: the derivative of an undistorted pinhole is the textbook's") {
  const model::Lens lens{.width = 640, .height = 480, .fx = 500, .fy = 510, .cx = 320, .cy = 240};
  const Eigen::Vector3d p{0.3, -0.2, 1.5};
  Eigen::Matrix<double, 2, 3> by;
  by << 500 / 1.5, 0, -500 * 0.3 / (1.5 * 1.5), 0, 510 / 1.5, 510 * 0.2 / (1.5 * 1.5);
  CHECK((Projection{lens}.derivative(p) - by).cwiseAbs().maxCoeff() < kDifferences);
}

}  // namespace fathom::vision
