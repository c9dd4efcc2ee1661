// Hydrodynamic derivatives from reconstructed trials, degree of freedom by degree of freedom (Pereira and Duncan, sec.
// VI): what mass, weight, thrusters, umbilical and chain do not explain is regressed on products of velocities.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/identification/regression/stepwise.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/recording.hpp"

namespace fathom::identification {

struct RegressionSettings {
  double rate{10.0};                              ///< Hz, of the rows: averages of what is recorded faster
  Eigen::Vector3d v_WF{Eigen::Vector3d::Zero()};  ///< m/s, steady velocity of the water, beside what a log tells
  double block{2.0};                              ///< s, of the blocks that tell how independent samples are
  double cell_gain{0.03};                         ///< std of a load cell's gain: makers' and mounting's together
  double thrust_gain{0.10};                       ///< std of a thruster's force over what its curve says
  bool errors{true};  ///< of every term also what its scatter does not tell (term_errors.hpp)
  StepwiseSettings stepwise;
};

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
  std::size_t cells{};                                      ///< so many of the parts are load cells, the rest computed
  Eigen::Vector3d sigma_attitude{Eigen::Vector3d::Zero()};  ///< rad, typical of SMOOTHED
  Eigen::Vector3d sigma_velocity{Eigen::Vector3d::Zero()};  ///< m/s
};

/// InputError in one line when the log holds no SMOOTHED, or no force at all, or load cells that are not the file's.
[[nodiscard]] ManoeuvreRows rows_of(const Recording& recording, const model::Vehicle& vehicle, double rate);

/// Columns of one axis and what they shall explain, dimensionless numbers as unknowns.
struct AxisCandidates {
  std::vector<std::string> names;
  std::vector<const model::ManoeuvringTerm*> terms;
};
[[nodiscard]] AxisCandidates candidates_of(int axis);
/// A column per candidate, and b.
[[nodiscard]] Eigen::MatrixXd columns_of(const std::vector<ManoeuvreRows::Row>& stretch, int axis,
                                         const AxisCandidates& candidates, const model::Vehicle& vehicle,
                                         const Eigen::Vector3d& v_WF);
[[nodiscard]] LaggedGram gram_of(const ManoeuvreRows& rows, int axis, const AxisCandidates& candidates,
                                 const model::Vehicle& vehicle, const RegressionSettings& settings);

struct AxisRegression {
  int axis{};
  AxisCandidates candidates;
  std::vector<StepwiseResult> manoeuvres;  ///< each by itself
  StepwiseResult together;                 ///< all, cross-validated over manoeuvres
};

/// All six axes. InputError when the vehicle file has no hydrodynamics.
[[nodiscard]] std::vector<AxisRegression> regress(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                                  const RegressionSettings& settings);

/// The horizontal velocity of the water under which surge, sway and yaw leave least, searched within 1 m/s.
[[nodiscard]] Eigen::Vector3d estimate_current(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                               RegressionSettings settings);

}  // namespace fathom::identification
