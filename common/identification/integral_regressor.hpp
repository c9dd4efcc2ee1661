// Regressor rows from noisy motion without ever differentiating it: both sides of M nu_dot + ... = tau are averaged
// with a smooth bump phi over a sliding window, and integration by parts moves the derivative onto phi:
//   int phi nu_dot dt = -int phi' nu dt      (phi = phi' = 0 at both ends; Shinbrot 1957, modulating functions)
// A raw accelerometer or a difference quotient in the regressor attenuates the masses; this does not.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"
#include "common/identification/rows.hpp"
#include "common/model/parameters.hpp"

namespace fathom::identification {

/// Motion and applied wrench at one instant.
struct MotionSample {
  Utime utime{};
  Vector6d nu{Vector6d::Zero()};                     ///< m/s, rad/s
  Eigen::Vector3d down_B{Eigen::Vector3d::UnitZ()};  ///< R_WB^T e_z
  Vector6d tau{Vector6d::Zero()};                    ///< N, N m
  Eigen::Vector3d sigma_v{Eigen::Vector3d::Zero()};  ///< m/s, of u v w
  bool valid{false};                                 ///< false: no window may contain this instant
};

struct IntegralSettings {
  double window{2.0};                ///< s; motion faster than about 1/window is averaged away
  double stride{0.5};                ///< s between rows
  double max_gap{0.35};              ///< s between samples beyond which the window starts over
  double max_rate{200.0};            ///< 1/s; samples that come faster are skipped
  std::array<bool, 6> dof{};         ///< axes that give rows
  Vector6d sigma{Vector6d::Ones()};  ///< N, N m: what averaging leaves of the noise
  /// N per m/s along X Y Z: what velocities known worse than `ordinary_sigma_v` [m/s] leave beyond that.
  Eigen::Vector3d per_velocity{Eigen::Vector3d::Zero()};
  double ordinary_sigma_v{};
  Eigen::Vector3d mass{
      Eigen::Vector3d::Zero()};  ///< kg along X Y Z, about: two of them and two velocities make a moment
  std::vector<model::BaseParameter> parameters;  ///< columns
};

class IntegralRegressor {
 public:
  /// InputError when a setting makes no sense or there are more than kMaxParameters columns.
  explicit IntegralRegressor(IntegralSettings settings);

  /// Takes one sample; hands out rows when a window is full and `stride` has gone by. Allocates nothing.
  [[nodiscard]] std::optional<RowBlock> step(const MotionSample& sample);
  void reset();

  /// Whether the last step() kept its sample (it does not when samples come too fast or are not valid).
  [[nodiscard]] bool took() const { return took_; }
  /// Most samples that a window can hold.
  [[nodiscard]] std::size_t capacity() const { return ring_.size(); }
  /// Weights with which the last rows average over the last average().size() kept samples, oldest first...
  [[nodiscard]] std::span<const double> average() const { return {average_.data(), weighed_}; }
  /// ...and those that turn samples of a quantity into the average of its derivative.
  [[nodiscard]] std::span<const double> derivative() const { return {derivative_.data(), weighed_}; }

 private:
  [[nodiscard]] RowBlock rows(std::size_t count);
  void weigh(std::size_t count);
  [[nodiscard]] const MotionSample& sample(std::size_t i) const { return ring_[(first_ + i) % ring_.size()]; }

  IntegralSettings settings_;
  std::vector<MotionSample> ring_;
  std::size_t first_{};
  std::size_t size_{};
  std::size_t weighed_{};
  bool took_{false};
  std::optional<Utime> last_rows_;
  std::vector<double> average_;     // phi times the sample's share of time; sums to 1
  std::vector<double> derivative_;  // likewise for -phi'
};

}  // namespace fathom::identification
