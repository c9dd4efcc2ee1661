#include "common/vision/projection.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/units.hpp"
#include "common/vision/lens_equations.hpp"

namespace fathom::vision {

Eigen::Vector2d Projection::pixel(const Eigen::Vector3d& p_C) const {
  const std::array<double, 4> f{lens_.fx, lens_.fy, lens_.cx, lens_.cy};
  return projected<double>(lens_, f.data(), lens_.distortion.data(), p_C);
}

Eigen::Matrix<double, 2, 3> Projection::derivative(const Eigen::Vector3d& p_C) const {
  const double step = 1e-6 * p_C.norm();  // central differences: error of the order of 1e-9
  Eigen::Matrix<double, 2, 3> by;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Vector3d move = step * Eigen::Vector3d::Unit(i);
    by.col(i) = (pixel(p_C + move) - pixel(p_C - move)) / (2.0 * step);
  }
  return by;
}

// Newton on the distortion, with its derivative by differences; where a lens folds back there is no answer and the last
// step stands.
Eigen::Vector2d Projection::undistorted(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d seen{(pixel.x() - lens_.cx) / lens_.fx, (pixel.y() - lens_.cy) / lens_.fy};
  constexpr int kSteps = 20;
  constexpr double kGood = 1e-12, kStep = 1e-6, kFarthest = 50.0;
  Eigen::Vector2d at = seen;
  if (lens_.kind == model::Lens::Kind::kFisheye) {
    const double angle = std::min(seen.norm(), 1.5);
    if (angle > 1e-9) at = seen / seen.norm() * std::tan(angle);
  }
  const auto value = [&](const Eigen::Vector2d& p) {
    return distorted<double>(lens_.kind, lens_.distortion.data(), p.x(), p.y());
  };
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector2d error = value(at) - seen;
    if (error.squaredNorm() < kGood * kGood) break;
    Eigen::Matrix2d by;
    by.col(0) = (value(at + Eigen::Vector2d{kStep, 0.0}) - value(at - Eigen::Vector2d{kStep, 0.0})) / (2.0 * kStep);
    by.col(1) = (value(at + Eigen::Vector2d{0.0, kStep}) - value(at - Eigen::Vector2d{0.0, kStep})) / (2.0 * kStep);
    const double det = by.determinant();
    if (!(std::abs(det) > 1e-9)) break;
    at -= by.inverse() * error;
    if (!(at.norm() < kFarthest)) return seen;
  }
  return at;
}

bool Projection::sees(const Eigen::Vector2d& pixel) const {
  if (lens_.undistorted()) return true;
  constexpr int kSteps = 10;
  constexpr double kStep = 1e-6, kBack = 1e-6;
  const Eigen::Vector2d seen{(pixel.x() - lens_.cx) / lens_.fx, (pixel.y() - lens_.cy) / lens_.fy};
  const Eigen::Vector2d at = undistorted(pixel);
  const auto value = [&](const Eigen::Vector2d& p) {
    return distorted<double>(lens_.kind, lens_.distortion.data(), p.x(), p.y());
  };
  if (!((value(at) - seen).norm() < kBack)) return false;
  // From the middle outward the picture grows: beyond a fold it would be another direction's.
  for (int i = 1; i <= kSteps; ++i) {
    const Eigen::Vector2d p = static_cast<double>(i) / kSteps * at;
    Eigen::Matrix2d by;
    by.col(0) = value(p + Eigen::Vector2d{kStep, 0.0}) - value(p - Eigen::Vector2d{kStep, 0.0});
    by.col(1) = value(p + Eigen::Vector2d{0.0, kStep}) - value(p - Eigen::Vector2d{0.0, kStep});
    if (!(by.determinant() > 0.0)) return false;
  }
  return true;
}

std::optional<Eigen::Vector2d> Projection::first_unseen() const {
  constexpr int kEvery = 8;  // px
  if (lens_.undistorted()) return {};
  for (int y = 0; y < lens_.height; y += kEvery) {
    for (int x = 0; x < lens_.width; x += kEvery) {
      const Eigen::Vector2d pixel{x, y};
      if (!sees(pixel)) return pixel;
    }
  }
  return {};
}

std::string lens_doubts(const model::Lens& lens) {
  constexpr double kNarrowest = 0.01, kWidest = 3.0;        // rad
  if (lens.kind == model::Lens::Kind::kFisheye) return {};  // its picture may be a disc
  const Projection projection{lens};
  const double middle = 0.5 * lens.height;
  const Eigen::Vector3d left = projection.ray({0.0, middle}).direction;
  const double view = std::acos(std::clamp(left.dot(projection.ray({lens.width - 1.0, middle}).direction), -1.0, 1.0));
  if (!(view > kNarrowest && view < kWidest)) {
    return "the lens sees " + std::to_string(view / kDegree).substr(0, 5) +
           " deg from left to right: is 'focal' in pixels, and 'width' that of this camera?";
  }
  if (const auto unseen = projection.first_unseen()) {
    return "the lens's distortion folds back within the picture, at pixel " + std::to_string(std::lround(unseen->x())) +
           " " + std::to_string(std::lround(unseen->y())) +
           " for one: what is there is left out; calibrate with tags up to the corners, or with fewer coefficients "
           "(fathom calibrate --distortion)";
  }
  return {};
}

Ray Projection::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d at = undistorted(pixel);
  const double t = at.norm();
  if (!lens_.port || t < 1e-12) {
    return {.direction = Eigen::Vector3d{at.x(), at.y(), 1.0}.normalized()};
  }
  const model::FlatPort& port = *lens_.port;
  const Eigen::Vector2d out = at / t;
  const double s = t / std::sqrt(1.0 + t * t);
  const double in_window = s / port.index_window, in_water = s / port.index_water;
  const double radius = port.distance * t + port.thickness * in_window / std::sqrt(1.0 - in_window * in_window);
  const double z = port.distance + port.thickness;
  return {.origin = {out.x() * radius, out.y() * radius, z},
          .direction = {out.x() * in_water, out.y() * in_water, std::sqrt(1.0 - in_water * in_water)}};
}

Eigen::Vector2d Projection::normalized(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector3d direction = ray(pixel).direction;
  return direction.head<2>() / direction.z();
}

bool Projection::inside(const Eigen::Vector2d& pixel, double border) const {
  return pixel.x() >= border - 0.5 && pixel.y() >= border - 0.5 && pixel.x() <= lens_.width - 0.5 - border &&
         pixel.y() <= lens_.height - 0.5 - border;
}

}  // namespace fathom::vision
