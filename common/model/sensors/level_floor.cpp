#include "common/model/sensors/level_floor.hpp"

namespace fathom::model {
namespace {

constexpr double kFlattest = 0.17;  // cosine of 80 deg between line of sight and down: flatter, no distance can be told

/// With h the height of Co above the floor and c the cosine of the line of sight to the vertical, d = h / c:
/// dd/dp_z = -1 / c, dd/d(down_B) = -(p_BC + d u_B) / c, and down_B turns with the angles.
struct Sight {
  double distance{};
  double by_depth{};
  Eigen::Vector3d by_angles{Eigen::Vector3d::Zero()};
};

std::optional<Sight> sight(const KinematicPoint& point, double floor, const Pose& X_BC,
                           const Eigen::Vector3d& along_C) {
  const Eigen::Vector3d u_B = X_BC.q * along_C;
  const double c = point.down_B.dot(u_B);
  const double h = floor - point.x[at::kPosition + 2] - point.down_B.dot(X_BC.p);
  if (c < kFlattest || h <= 0.0) return std::nullopt;
  Sight seen{.distance = h / c, .by_depth = -1.0 / c};
  const Eigen::Vector3d by_down = -(X_BC.p + seen.distance * u_B) / c;
  seen.by_angles = point.turned_in(point.down_B).transpose() * by_down;
  return seen;
}

}  // namespace

std::optional<double> distance_to_floor(const KinematicPoint& point, double floor, const Pose& X_BC,
                                        const Eigen::Vector3d& along_C) {
  const auto seen = sight(point, floor, X_BC, along_C);
  return seen ? std::optional{seen->distance} : std::nullopt;
}

std::optional<std::array<Observation, 3>> observe_flow(const KinematicPoint& point, double floor, const Pose& X_BC,
                                                       const Eigen::Vector3d& measured,
                                                       const Eigen::Vector3d& variance) {
  const auto seen = sight(point, floor, X_BC, Eigen::Vector3d::UnitZ());
  if (!seen) return std::nullopt;
  const double d = seen->distance;
  const Eigen::Matrix3d R_CB = X_BC.q.toRotationMatrix().transpose();
  const Eigen::Vector3d v_B = point.R_WB.transpose() * point.group(at::kVelocity);
  const Eigen::Vector3d v_C = R_CB * (v_B + point.group(at::kRates).cross(X_BC.p));
  const Eigen::Matrix3d by_velocity = R_CB * point.R_WB.transpose();
  const Eigen::Matrix3d by_angles = R_CB * point.turned_in(v_B), by_rates = -R_CB * skew(X_BC.p);
  std::array<Observation, 3> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    const double by_distance = v_C[i] / (d * d);
    one.innovation = measured[i] + v_C[i] / d;
    one.variance = variance[i];
    one.set(at::kPosition, {0.0, 0.0, by_distance * seen->by_depth});
    one.set(at::kVelocity, -by_velocity.row(i).transpose() / d);
    one.set(at::kAngles, -by_angles.row(i).transpose() / d + by_distance * seen->by_angles);
    if (!X_BC.p.isZero(0.0)) one.set(at::kRates, -by_rates.row(i).transpose() / d);
  }
  return result;
}

std::optional<Observation> observe_floor_point(const KinematicPoint& point, double floor, const Pose& X_BC,
                                               const Eigen::Vector3d& p_CL, double variance) {
  const double range = p_CL.norm();
  if (!(range > 0.0)) return std::nullopt;
  const auto seen = sight(point, floor, X_BC, p_CL / range);
  if (!seen) return std::nullopt;
  Observation one;
  one.innovation = range - seen->distance;
  one.variance = variance;
  one.set(at::kPosition, {0.0, 0.0, seen->by_depth});
  one.set(at::kAngles, seen->by_angles);
  return one;
}

}  // namespace fathom::model
