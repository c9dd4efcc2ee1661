// The last fit, to all data, on windows as long as they can be without misleading. Where motion grows by itself (a
// vehicle whose buoyancy rises as it rises) what is wrong at a window's beginning grows too, and the cost of long
// windows is full of hollows; short windows, which begin anew from what was measured, have none.
#pragma once

#include <optional>

#include "common/diagnosis/questions.hpp"

namespace fathom::diagnosis {

struct Everything {
  identification::TrajectoryFit problem;
  identification::FitResult fit;
};

/// Fits `found` to all of `train`. `near.reference` is the fit of the same effects to short windows: a fit to long ones
/// that leaves far more there than they need has gone astray, and shorter ones are taken. `vehicle` must outlive it.
[[nodiscard]] Everything fit_everything(const model::Vehicle& vehicle, std::span<const Trial> train,
                                        const Settings& settings, const NearView& near, const model::Model& found);

/// The numbers of `by_speeds`, which has its covariance and intervals, by places and attitudes too, where these bear it
/// out (identification::fit_with_poses). `window`: s, of `by_speeds`.
[[nodiscard]] std::optional<identification::FitResult> with_poses(const model::Vehicle& vehicle,
                                                                  std::span<const Trial> train,
                                                                  const Settings& settings, double window,
                                                                  const identification::FitResult& by_speeds);

}  // namespace fathom::diagnosis
