// The kinematic state of Pereira and Duncan (eqs. 6 to 11) at one instant, with what every observation needs of it.
// Observations of single sensors are the other files of this folder: each gives innovation and row at a point.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>
#include <optional>

#include "common/base/spatial.hpp"

namespace fathom::model {

/// Where the groups of three begin: position and velocity in W; attitude (KinematicPoint); acceleration of Bo in W seen
/// in B (inertial: v_dot + w x v); rates and their derivatives in B; biases of accelerometers, gyros and velocity log
/// in B; of accelerometers and gyros beside the inertial package, each along its own axis.
namespace at {
inline constexpr int kPosition = 0;
inline constexpr int kVelocity = 3;
inline constexpr int kAngles = 6;
inline constexpr int kAcceleration = 9;
inline constexpr int kRates = 12;
inline constexpr int kRateSlopes = 15;
inline constexpr int kBias = 18;
inline constexpr int kLogBias = 24;
inline constexpr int kSingleBias = 27;
}  // namespace at
inline constexpr int kKinematicStates = 18;
inline constexpr int kInertialStates = kKinematicStates + 6;          ///< with the biases of accelerometers and gyros
inline constexpr int kLoggedStates = kInertialStates + 3;             ///< with that of a velocity log
inline constexpr int kMostSingles = 9;                                ///< accelerometers and gyros beside the package
inline constexpr int kMostStates = kLoggedStates + kMostSingles;      ///< with theirs
inline constexpr double kGravity = 9.80665;                           ///< m/s^2
inline constexpr double kSteepest = 85.0 * std::numbers::pi / 180.0;  ///< rad, pitch beyond which roll and yaw blur

using KinematicVector = Eigen::Matrix<double, kMostStates, 1>;

/// One scalar measurement seen from a point: z = h(x) + noise, linear about x.
struct Observation {
  double innovation{};                           ///< z - h(x)
  double variance{};                             ///< of the noise; infinite: dropped out, changes nothing
  KinematicVector row{KinematicVector::Zero()};  ///< dh/dx
  unsigned groups{};                             ///< bit i: the row's entries 3i .. 3i + 2 are not all zero

  /// Writes three entries of the row at `begin` (one of `at`).
  void set(int begin, const Eigen::Vector3d& entries) {
    row.segment<3>(begin) = entries;
    groups |= 1U << static_cast<unsigned>(begin / 3);
  }
  /// The measurement holds the state's bias number `bias` too.
  void add_bias(const KinematicVector& x, int bias) {
    const int entry = at::kBias + bias;
    innovation -= x[entry];
    row[entry] = 1.0;
    groups |= 1U << static_cast<unsigned>(entry / 3);
  }
};

struct KinematicPoint {
  /// The attitude is a rotation vector in B, of the error state on SO(3): R_WB = reference exp(x). Without a reference
  /// it is roll, pitch and yaw, the state that the paper prints.
  explicit KinematicPoint(const KinematicVector& state, const std::optional<Eigen::Matrix3d>& reference = std::nullopt);

  KinematicVector x;
  Eigen::Matrix3d R_WB;
  Eigen::Matrix3d turn_from_angles;  ///< small turns in B by small changes of the three numbers; of roll, pitch, yaw:
                                     ///< inverse of Fossen 2011, eq. 2.28
  Eigen::Vector3d down_B;            ///< R_WB^T e_z

  [[nodiscard]] Eigen::Vector3d group(int begin) const { return x.segment<3>(begin); }
  /// d(R_WB a_B)/d(angles).
  [[nodiscard]] Eigen::Matrix3d turned_out(const Eigen::Vector3d& a_B) const {
    return -R_WB * skew(a_B) * turn_from_angles;
  }
  /// d(R_WB^T c_W)/d(angles), with c_B = R_WB^T c_W.
  [[nodiscard]] Eigen::Matrix3d turned_in(const Eigen::Vector3d& c_B) const { return skew(c_B) * turn_from_angles; }
  /// Writes the row of what grows as the point p_BP of the hull moves along `along_W`.
  void set_along(const Eigen::Vector3d& along_W, const Eigen::Vector3d& p_BP, Observation& observation) const {
    observation.set(at::kPosition, along_W);
    if (!p_BP.isZero(0.0)) observation.set(at::kAngles, (along_W.transpose() * turned_out(p_BP)).transpose());
  }
};

}  // namespace fathom::model
