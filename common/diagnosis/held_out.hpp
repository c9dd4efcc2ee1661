// Does a model carry over to data that had no part in its estimate? By linear algebra on derivatives that are there.
#pragma once

#include "common/diagnosis/screening.hpp"

namespace fathom::diagnosis {

/// Cost on windows left out of the estimate, each fold predicted by the linear fit to all others.
struct HeldOut {
  double blocks{};  ///< folds of 30 s blocks, spread over all runs
  double runs{};    ///< a run a fold; equal to `blocks` with fewer than three runs
};

/// How much larger the scatter of window gradients is than independent samples would make it: the factor by which
/// correlated residuals overstate their information against a prior. At least 1.
[[nodiscard]] double inflation(const Linearisation& fit);
[[nodiscard]] HeldOut held_out(const Linearisation& fit, double inflation);

}  // namespace fathom::diagnosis
