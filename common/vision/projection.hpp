// Points to pixels and pixels to rays, through a lens and a housing's flat window. Frame C: x right, y down, z out.
// Pixels count from the middle of the first one, as OpenCV does.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "common/model/lens.hpp"

namespace fathom::vision {

/// A line of sight. Without a port it begins in the lens.
struct Ray {
  Eigen::Vector3d origin{Eigen::Vector3d::Zero()};      ///< m, in C
  Eigen::Vector3d direction{Eigen::Vector3d::UnitZ()};  ///< unit, in C
};

class Projection {
 public:
  explicit Projection(const model::Lens& lens) : lens_{lens} {}

  /// Pixel of a point before the camera (z > 0).
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector3d& p_C) const;
  /// Its derivative by p_C [px/m].
  [[nodiscard]] Eigen::Matrix<double, 2, 3> derivative(const Eigen::Vector3d& p_C) const;
  /// The line of sight of a pixel, in water where there is a port.
  [[nodiscard]] Ray ray(const Eigen::Vector2d& pixel) const;
  /// The same as a point at z = 1, a port's offset neglected: small against what a camera sees.
  [[nodiscard]] Eigen::Vector2d normalized(const Eigen::Vector2d& pixel) const;
  /// False where a distortion folds back (a polynomial beyond where it was fitted): nothing projects there, or what
  /// does is seen elsewhere too.
  [[nodiscard]] bool sees(const Eigen::Vector2d& pixel) const;
  /// Whether there are such places in the picture.
  [[nodiscard]] bool folds() const { return first_unseen().has_value(); }
  [[nodiscard]] std::optional<Eigen::Vector2d> first_unseen() const;  ///< px, to within some
  [[nodiscard]] bool inside(const Eigen::Vector2d& pixel, double border = 0.0) const;
  [[nodiscard]] const model::Lens& lens() const { return lens_; }

 private:
  [[nodiscard]] Eigen::Vector2d undistorted(const Eigen::Vector2d& pixel) const;
  model::Lens lens_;
};

/// A line about a lens that cannot be meant so; empty when there is nothing to say.
[[nodiscard]] std::string lens_doubts(const model::Lens& lens);

}  // namespace fathom::vision
