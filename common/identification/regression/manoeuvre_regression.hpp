// Hydrodynamic derivatives from reconstructed trials, degree of freedom by degree of freedom (Pereira and Duncan, sec.
// VI): what mass, weight, thrusters, umbilical and chain do not explain is regressed on products of velocities.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/identification/regression/manoeuvre_rows.hpp"
#include "common/identification/regression/stepwise.hpp"
#include "common/model/vehicle.hpp"

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

/// Columns of one axis and what they shall explain, dimensionless numbers as unknowns.
struct AxisCandidates {
  std::vector<std::string> names;
  std::vector<const model::ManoeuvringTerm*> terms;
};
/// Those of a set that have neither a rudder, whose force is known, nor two axes.
[[nodiscard]] AxisCandidates candidates_of(int axis, const model::StandardSet& set);
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

/// All six axes. InputError as need_hydrodynamics.
[[nodiscard]] std::vector<AxisRegression> regress(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                                  const RegressionSettings& settings);

/// The horizontal velocity of the water under which surge, sway and yaw leave least, searched within 1 m/s.
[[nodiscard]] Eigen::Vector3d estimate_current(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                               RegressionSettings settings);

}  // namespace fathom::identification
