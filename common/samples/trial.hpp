// One run made ready for fitting: a uniform grid, checked and corrected signals, one validity flag per group.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"

namespace fathom {

/// Which groups of a trial's signals exist at all.
struct Observed {
  bool position{false};
  bool attitude{false};
  bool velocity{false};
  bool rates{false};
};

/// Signals of one run on a uniform grid of `dt`. Frames: W NED, B forward-right-down.
struct Trial {
  std::string name;
  double dt{};  ///< s
  Observed observed;
  std::vector<double> t;                 ///< s from the run's start (of the whole run, where this is a part of one)
  std::vector<Eigen::Vector3d> p_WB;     ///< m; zero when not observed
  std::vector<Eigen::Quaterniond> q_WB;  ///< unit; identity when not observed
  std::vector<Vector6d> nu;              ///< u v w [m/s] p q r [rad/s], reference for fit and score
  std::vector<std::uint8_t> pose_valid;  ///< 0 where pose is a guess across a gap
  std::vector<std::uint8_t> velocity_valid;
  std::vector<std::uint8_t> rates_valid;
  std::vector<Eigen::VectorXd> input;  ///< actuator forces [N] (order of the vehicle file), or the wrench [N, N m]
  /// 0 where input is a guess across a gap too long to hold a command over; empty: known everywhere.
  std::vector<std::uint8_t> input_valid;
  bool input_is_wrench{false};  ///< true: input has 6 entries, the wrench at the body origin in body axes
  double input_step{};          ///< s between inputs as they were recorded
  bool input_averaged{false};   ///< they came faster than the grid: `input` are means around each time
  double input_part{};          ///< s over which inputs may be averaged for what the vehicle does; 0: any time
  /// Mean over each of parts() equal parts of each step if inputs are held until the next one; empty: `input` itself.
  /// Inputs around a time count as the velocities there were averaged.
  std::vector<Eigen::VectorXd> held;
  std::vector<Eigen::VectorXd> told;  ///< the same if inputs act from the one before on; empty: the next of `input`
  std::vector<double> voltage;        ///< V; empty when not logged
  /// Of each of the vehicle's candidates (Vehicle::candidates) the product of its measured columns and the bearing
  /// [rad] that it goes along, 0 where it has none: of the step that begins there. Empty: no candidate is asked.
  std::vector<Eigen::VectorXd> columns;
  std::vector<std::string> column_units;  ///< of these products
  Vector6d nu_sigma{Vector6d::Zero()};    ///< noise of nu, m/s and rad/s, as estimated from the data

  [[nodiscard]] std::size_t size() const { return t.size(); }
  [[nodiscard]] std::size_t parts() const { return held.size() > t.size() ? held.size() / t.size() : 1; }
};

/// Whether both are stretches of one run, between whose gaps they lie: of one name, one after the other.
[[nodiscard]] inline bool same_run(const Trial& a, const Trial& b) {
  if (&a == &b) return true;
  if (a.name.empty() || a.name != b.name || a.t.empty() || b.t.empty()) return false;
  return a.t.back() < b.t.front() || b.t.back() < a.t.front();
}

}  // namespace fathom
