// Evidence of what acts seldom: by what is left where it acts, once it is in the model.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Log-likelihood ratio of the numbers at `places` of a fit against zero: Wald's statistic W with the covariance that
/// comes of leaving one piece of the data out at a time (MacKinnon and White 1985, HC3, by pieces), and m/2 ln(1 + W/m)
/// with m the number of pieces that say something of the numbers. What acts in a few pieces only, but there beyond
/// doubt, is not refused for acting seldom. A piece is a window, or a part of one where what is left has so short a
/// memory that parts tell of the numbers independently: left is then noise of the sensors, not what a model lacks.
[[nodiscard]] double ratio_where_it_acts(const identification::TrajectoryFit& problem,
                                         const identification::FitResult& fit, std::span<const Eigen::Index> places);

/// s; memory (integrated autocorrelation) of what is left, seen as `direction` (one entry per scaled number) sees it.
/// Windows count as much as they say of it.
[[nodiscard]] double memory_of_scores(const identification::TrajectoryFit& problem,
                                      std::span<const identification::ProjectedWindow> windows,
                                      const Eigen::VectorXd& direction);

}  // namespace fathom::diagnosis
