// What a residual may go with: quantities that were measured, written as columns of a regression. Beside them stand the
// columns that the base model's own numbers take up: where noise with a memory has bent those, that is no structure.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/samples/trial.hpp"

namespace fathom::diagnosis {

/// The sample at which a residual's span begins, with the velocity that the model predicts there: the measured one
/// carries the noise that is also in the residual, and noise with a memory would go with itself.
struct Moment {
  const Trial& trial;
  std::size_t k;
  Vector6d nu;                  ///< m/s, rad/s; 0 along axes that are not simulated
  std::array<Vector6d, 3> tau;  ///< N, N m: applied now, and one and two residual spans ago; NaN before the run
  std::span<const bool> dof;    ///< axes that are simulated
  Vector6d nu_rms;              ///< m/s, rad/s: over all runs
};

using Columns = std::vector<double>;

struct Suspect {
  const char* name;
  bool (*seen)(const Trial&);
  void (*columns)(const Moment&, int axis, Columns& row);  ///< appends
};

[[nodiscard]] std::span<const Suspect> suspects();

/// With what the size of a residual may go, whatever its sign.
struct Circumstance {
  const char* name;
  bool (*seen)(const Trial&);
  double (*of)(const Moment&, int axis);
};

[[nodiscard]] std::span<const Circumstance> circumstances();

constexpr int kBaseColumns = 9;
/// A constant, thrust, drag, what added mass couples, and restoring moments, of one axis.
void base_columns(const Moment& at, int axis, Columns& row);

}  // namespace fathom::diagnosis
