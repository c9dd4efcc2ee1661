// The three kinematic identities as increment problems, and one estimate of a sensor's faults pooled over recordings.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/consistency/increments/increments.hpp"
#include "common/estimation/corrections.hpp"
#include "common/estimation/wording.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::consistency {

using estimation::Corrections;
using estimation::SensorFault;
using estimation::text;

/// R(t + L) - R(t) against the integral of R [w]x: gyro against attitude. Fixed columns: bias (3).
[[nodiscard]] IncrementProblem rate_problem(const PoseSeries& pose);
/// p(t + L) - p(t) against the integral of R v. Fixed columns: bias (3), lever (3), heading (1); with `rates` also the
/// six numbers of a symmetric coupling to the rates, which no lever arm can make: its column is zero unless the vehicle
/// truly turns about both axes, for about one alone a lever arm does the same.
[[nodiscard]] IncrementProblem velocity_problem(const PoseSeries& pose, const Series* rates);
/// Rows and columns of those six.
inline constexpr std::array<std::array<int, 2>, 6> kSymmetric{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
/// Second difference of p against the triangle-weighted integral of R f + g. Fixed columns: lever (3). No bias: on a
/// vehicle that stays level it cannot be told from a tilted mount.
[[nodiscard]] IncrementProblem acceleration_problem(const PoseSeries& pose);

/// What a pair of signals is called and from which size on a disagreement matters in practice.
struct PairNames {
  std::string signal;               ///< "gyro"
  std::string reference;            ///< "pose_capture"
  std::array<std::string, 3> axes;  ///< "p", "q", "r"
  std::string unit;                 ///< of a bias
  double bias_floor{};              ///< in that unit
  bool has_bias{true};              ///< the problem's first three fixed columns
};

/// What can be said of one quantity: agree, disagree, or cannot tell.
enum class Answer { kAgree, kDisagree, kCannotTell };
struct Statement {
  std::string signal, reference, quantity;  ///< "dvl.u", "pose_capture", "scale"
  std::string unit;
  Answer answer{Answer::kCannotTell};
  double value{}, sigma{};  ///< the mismatch as measured, all recordings together; sigma infinite where none says it
  double neutral{};         ///< value without a fault
  double seen{};            ///< the smallest mismatch that would have been called significant
  double practical{};  ///< a fault of this size must not be passed over: "agree" is only said where it would be seen
};

/// Finds the faults that are significant and large enough, pooled over recordings; a recording that differs has its
/// own.
struct PairResult {
  bool checked{false};
  std::vector<IncrementFit> fits;   ///< per recording
  std::vector<SensorFault> faults;  ///< per recording; the neutral element where nothing was found
  double explained{};               ///< median robust R^2 of the informative recordings
  std::vector<Statement> statements;
  std::vector<ConsistencyFinding> findings;
};
[[nodiscard]] PairResult compare(const PairNames& names, std::span<const std::string> runs,
                                 std::vector<IncrementFit> fits);

}  // namespace fathom::consistency
