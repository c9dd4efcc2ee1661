// Every number at which learning decides, with its reason.
#pragma once

#include "common/residual/open_loop.hpp"

namespace fathom::learning {

struct Limits {
  double odds{20.0};    ///< nats over the best listed model: features are chosen among hundreds
  double size{0.01};    ///< share of the applied acceleration on its worst axis: below, complete models have such rests
  double error{0.98};   ///< most of the base model's open-loop error on what was left out, geometric mean
  double carried{1.0};  ///< the same of the part that other runs are told
  double judged{1.02};  ///< most of the error on runs that judge over the model's without it: less is chance
  double sure{1.3};     ///< standard errors by which the logarithm of that ratio lies below 0: one-sided 90 %
  double form{10.0};    ///< nats by which a closed form may lie below the table of features that it replaces
  double swings{10.0};  ///< nats by which swings must be worth more than what lasts alone to be asked with it at once
  int fewest_windows{4};
  int most_groups{8};  ///< of products: more has never held on a new recording
  int rounds{
      3};  ///< screens: what lasts, then swings, then tables over time, each seen with the random force that is left
};

/// How the recording is left out in turn, and predicted where it was.
struct Leaving {
  int folds{4};
  double stretch{20.0};  ///< s left out at a time: two predictions of ten seconds
  residual::OpenLoop predicted{};
};

}  // namespace fathom::learning
