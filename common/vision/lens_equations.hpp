// From a point before the camera to its pixel, for any number type: plain, or the automatic derivatives of a solver.
// Pinhole with the distortion of Brown and Conrady, fisheye of Kannala and Brandt (2006), both with OpenCV's
// coefficients; before either, if there is one, a flat port: Snell's law twice (Treibitz et al. 2012, eq. 3).
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "common/model/lens.hpp"

namespace fathom::vision {

/// Tangent of the ray's angle in air that meets radius `r` [m] at depth `z` [m] before the lens.
template <class T>
T tangent_behind_port(const model::FlatPort& port, const T& r, const T& z) {
  using std::sqrt;
  const double window = port.index_window, water = port.index_water;
  const T in_water = z - port.distance - port.thickness;
  T t = r / (port.distance + port.thickness / window + in_water / water);  // right for small angles
  constexpr int kSteps = 7;  // Newton; the function is convex and smooth, so these reach the last bit below 80 deg
  for (int i = 0; i < kSteps; ++i) {
    // n sin(angle) is the same in every medium; s2 is its square in air.
    const T s2 = t * t / (1.0 + t * t), ds2 = 2.0 * t / ((1.0 + t * t) * (1.0 + t * t));
    const T g = window * window - s2, w = water * water - s2;
    const T s = sqrt(s2 + 1e-300), root_g = sqrt(g), root_w = sqrt(w);
    const T value = port.distance * t + port.thickness * s / root_g + in_water * s / root_w - r;
    const T slope =
        port.distance +
        0.5 * ds2 / s * (port.thickness * window * window / (g * root_g) + in_water * water * water / (w * root_w));
    t = t - value / slope;
  }
  return t;
}

/// Distorted normalized picture coordinates of the normalized direction (x, y).
template <class T>
Eigen::Matrix<T, 2, 1> distorted(model::Lens::Kind kind, const T* k, const T& x, const T& y) {
  using std::atan;
  using std::sqrt;
  const T r2 = x * x + y * y;
  if (kind == model::Lens::Kind::kFisheye) {
    const T r = sqrt(r2 + 1e-24);
    const T angle = atan(r), a2 = angle * angle;
    const T scale = angle * (1.0 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3])))) / r;
    return {x * scale, y * scale};
  }
  const T radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
          y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y};
}

/// Pixel of the point p_C [m]. `f` holds fx fy cx cy, `k` the distortion.
template <class T>
Eigen::Matrix<T, 2, 1> projected(const model::Lens& lens, const T* f, const T* k, const Eigen::Matrix<T, 3, 1>& p_C) {
  using std::sqrt;
  T x = p_C.x() / p_C.z(), y = p_C.y() / p_C.z();
  if (lens.port) {
    const T r = sqrt(p_C.x() * p_C.x() + p_C.y() * p_C.y() + 1e-24);
    const T t = tangent_behind_port<T>(*lens.port, r, p_C.z());
    x = p_C.x() / r * t;
    y = p_C.y() / r * t;
  }
  const Eigen::Matrix<T, 2, 1> d = distorted<T>(lens.kind, k, x, y);
  return {f[0] * d.x() + f[2], f[1] * d.y() + f[3]};
}

}  // namespace fathom::vision
