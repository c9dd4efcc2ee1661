// Rows of a regression from a smoothed run: motion, and the forces that are known, averaged over equal steps.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/recording.hpp"

namespace fathom::identification {

/// What pulls at the hull besides thrusters, when load cells measure it: names as in the vehicle file's `of`.
inline constexpr std::array<const char*, 2> kPulls{"umbilical", "chain"};

/// Rows of one manoeuvre, cut at gaps.
struct ManoeuvreRows {
  struct Row {
    Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
    Vector6d nu{Vector6d::Zero()}, nu_dot{Vector6d::Zero()};
    Vector6d known{Vector6d::Zero()};  ///< N, N m: thrusters, umbilical and chain, as measured
    std::array<Vector6d, kPulls.size()> pulls{Vector6d::Zero(), Vector6d::Zero()};  ///< what of it is theirs
    std::vector<Vector6d> parts{};  ///< and what each load cell and thruster says, whose gains err apart
    Eigen::Vector3d v_WF{Eigen::Vector3d::Zero()};  ///< m/s, the water's velocity as the log's SIGNAL tells it
    Eigen::Vector3d a_WF{Eigen::Vector3d::Zero()};  ///< m/s^2, its rate
  };
  std::string name;
  double dt{};                              ///< s
  std::vector<std::vector<Row>> stretches;  ///< of equal steps
  /// "load cells", "load cells and THRUSTERS", "THRUSTERS"; then ", the umbilical's length", ", the water's velocity"
  std::string known_from;
  double unsure{};      ///< s of the run that are left out, where SMOOTHED is much less sure than mostly
  std::size_t cells{};  ///< so many of the parts are load cells, the rest computed
  Eigen::Vector3d sigma_attitude{Eigen::Vector3d::Zero()};  ///< rad, typical of SMOOTHED
  Eigen::Vector3d sigma_velocity{Eigen::Vector3d::Zero()};  ///< m/s
};

/// InputError when the vehicle file has no hydrodynamics, without which there is nothing to regress.
void need_hydrodynamics(const model::Vehicle& vehicle);

/// InputError in one line when the log holds no SMOOTHED, or no force at all, or load cells that are not the file's.
[[nodiscard]] ManoeuvreRows rows_of(const Recording& recording, const model::Vehicle& vehicle, double rate);

}  // namespace fathom::identification
