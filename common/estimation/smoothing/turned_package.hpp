// How gyros and accelerometers stand in the hull, by the attitude that is told beside them: over seconds both must tell
// the same turn, seen along axes that are turned a little against each other.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/samples/sensors.hpp"

namespace fathom::estimation {

struct TurnedPackage {
  /// rad: R_BI = exp(turn), axes of the package in those of the attitude
  Eigen::Vector3d turn{Eigen::Vector3d::Zero()};
  /// rad, of its least certain component, the attitude being right on average: what it is off by for long comes on top
  double sigma{};
};

/// Least squares over windows of two seconds, rotation vectors of both: y_gyro - y_attitude = y_attitude x turn + b t,
/// b the gyros' bias. Huber's weights, since an attitude may leap. Nothing where attitude or rates are missing, or
/// where too little turning tells all three.
[[nodiscard]] std::optional<TurnedPackage> turned_package(std::span<const Ahrs> stream);

}  // namespace fathom::estimation
