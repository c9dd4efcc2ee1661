// Every number at which the inference decides, with its reason. Nothing else in this room compares with a constant of
// its own choosing; numerical tolerances stand beside their algorithms.
#pragma once

#include <cmath>

namespace fathom::inference {

struct Thresholds {
  double smallest_size{
      0.01};               ///< of an effect or a free force, over the applied acceleration on its worst axis: timing of
                           ///< thrust edges inside a sample is worth .003, complete models left at most .009
  double name_odds{10.0};  ///< nats over the model without it: numbers and noise are fitted in turn, exact to a few
  double name_probability{0.9};  ///< against other names, times how reliable names of that evidence are
  double even_evidence{1.6};     ///< nats at which a name would be as often wrong as right
  double free_force_odds{5.0};   ///< nats of the free force over the best listed model, after its own prices
  double pair_gain{8.0};         ///< nats that a pair must promise beyond its best single to be fitted
  double score_worth{8.0};       ///< nats a score must promise to be fitted: less cannot become a name
  int fits_per_round{3};         ///< best by score; the true one was among them in every simulated set
  int pairs_per_round{2};
  double search_blocks{6000};  ///< of recordings that are twice as long and longer, on which the search is made first
  int few_effects{4};      ///< what no list holds is imitated by as many names: with more, a model must leave nothing
  int most_effects{8};     ///< the prior has next to nothing beyond
  int most_own_flow{6};    ///< forms of what a craft's flow does by nature, beside them: all that it has at once
  double group_gain{3.0};  ///< nats, after its price, for which a group of features is taken up
  int most_groups{5};
  double group_price{2.5};      ///< nats of a variance of unknown order of magnitude
  double searched_price{10.0};  ///< nats more where a moment or a frequency was sought in the data
  double large_random{0.03};  ///< random over applied acceleration above which the scan is repeated with a fifth of it
  double swallowing_memory{2.0};  ///< s: and its memory, above which it may have swallowed what is slow
  double slow_memory{10.0};       ///< s: a random force that remembers for longer, above the smallest size, is no noise
  double following{0.0};          ///< least share of an axis' acceleration that the model must foretell
  double no_skill{1e-3};          ///< p-value over windows of a model that is no worse than "nothing changes"
  double beaten{0.05};            ///< p-value over windows below which an equation of its axis alone beats the model
  double idle_input{3.0};         ///< Student's t below which an axis' thrust does not act on it
  double foreign_unit{5.0};       ///< fitted over expected inertia, or its inverse: thrust in another unit
  double absurd{10.0};            ///< times its prior's mean and sigma together: a number that nothing can have
  double shortest{20.0};          ///< s of data to judge at all: ten blocks for each number of an ordinary model
  /// Share by which the open-loop error of the fitted runs surely falls with the numbers of the multi-horizon score. Of
  /// sealed sets with a complete model none had more than .002; where something unlisted acted it was .03 to .2, and
  /// unseen runs erred by as much less.
  double disagreement{0.01};
  /// Share by which names must raise the error on runs that judge, by more than chance, to be no claim: where they were
  /// right it rose by .017 at most (the test "claims"), and no sealed set has a model that errs by .02 more than
  /// without (71 sets).
  double misled{0.02};

  /// How often a name of that evidence, nats, is right, as sealed sets show (docs/benchmark.md has the curve): no model
  /// is exact, so that evidence of an approximate one does not make certain. The odds grow with its root, that is
  /// with the standard deviations that it is worth.
  [[nodiscard]] double reliability(double nats) const {
    const double odds = std::sqrt(std::fmax(nats, 0.0) / even_evidence);
    return odds / (1.0 + odds);
  }
};

}  // namespace fathom::inference
