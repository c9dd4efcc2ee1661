// Fast first look at a candidate: its trajectories change to first order, and everything that the base parameters and
// the initial velocities can imitate is projected out before it may claim any of the residual.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/diagnosis/linearisation.hpp"
#include "common/model/effect.hpp"

namespace fathom::diagnosis {

/// What a candidate would do, to first order around its best values.
struct Screened {
  const model::Effect* effect{};
  int variant{};
  std::string variant_name;
  std::vector<double> theta;        ///< best values found
  model::Model base;                ///< the fit's model after the step that its parameters take beside the candidate
  double gain{};                    ///< fall of the cost
  std::vector<double> window_cost;  ///< cost per window with the candidate
  Eigen::VectorXd signature;        ///< change of all residuals that only this candidate can make; unit norm
  double change{};                  ///< its norm
};

/// Searches the candidate's numbers from `starts`: from the best of them when there are many. Where all that
/// it has gained and the linear picture foretells is less than `worth` (a share of the cost), that picture is believed,
/// and the search ends.
[[nodiscard]] Screened screen(const Linearisation& base, const model::Effect& effect, int variant,
                              const std::string& variant_name, std::span<const std::vector<double>> starts,
                              double worth = 0.0);
/// Goes on from what a thinned linearisation found.
[[nodiscard]] Screened refine(const Linearisation& base, const Screened& rough);
/// What the numbers that a thinned linearisation found do there, without a further step.
[[nodiscard]] Screened seen_by(const Linearisation& base, const Screened& rough);

}  // namespace fathom::diagnosis
