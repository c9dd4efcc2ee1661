// What a diagnosis comes to, as data: one verdict, the causes that decided it with their values and thresholds, and for
// every candidate that was refused, the rule and what was missing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fathom::inference {

enum class Verdict {
  adequate,     ///< nothing of practical size is missing
  effect,       ///< named effects, each above its odds and its rivals
  ambiguous,    ///< something is there, and more than one name fits it
  unexplained,  ///< something is there that no listed effect explains
  no_model,     ///< the model does not follow its thrust along some axis, whose numbers mean nothing
  not_judged    ///< too short, or the filter did not run
};

enum class Cause {
  kNothingFound,     ///< no effect of practical size and odds
  kNamed,            ///< least probability of an accepted name
  kRivals,           ///< the same, below what a name needs: others fit as well
  kWeakEvidence,     ///< the same: names of so little evidence are not right often enough
  kFreeForce,        ///< log odds of a force that no list holds
  kSlowRandomForce,  ///< memory [s] of a random force of practical size: no noise
  kManyNames,     ///< names that the best model holds: as many as the search allows, so that it ended with more to find
  kNotFollowing,  ///< share of an axis' acceleration that the model explains
  kNoSkill,       ///< 1 - (error / error where nothing changes)^2 of an axis at 5 s, on runs that no fit has seen
  kWiring,        ///< share of the error that thrusters exchanged or reversed take away: likeliest reason of no_model
  kForceUnit,     ///< fitted inertias over those that the vehicle's file expects, median: another one
  kInputIdle,     ///< Student's t of an axis' thrust in an equation of its own: another one
  kAbsurdNumber,  ///< a base number on its bound, over its prior's size
  kTooShort,      ///< s of data
  kNotFinite,     ///< the filter diverged
  kOutOfTime,     ///< the search was cut short: what it did not ask may be there too
  kSensorsDisagree,   ///< log odds that a sensor's number is wrong, by comparing the sensors
  kSensorsUndecided,  ///< log odds between two sensors of which one is wrong: too few to tell which
  kBeginsUnseen,      ///< s into a run that judges, from which on far more is left than in the fitted ones
  kNamesMislead,      ///< share by which the error on runs that judge falls with the names: surely below zero
  kScoresDisagree     ///< share by which the open-loop error falls with the numbers of the multi-horizon score
};

enum class Rule {
  kOdds,         ///< log odds over the model without it
  kSize,         ///< share of the applied acceleration
  kProbability,  ///< against other names
  kBound,        ///< odds of numbers that stopped on a limit which says nothing
  kScore         ///< promised too little to be fitted
};

struct Reason {
  Cause cause{};
  double value{}, threshold{};
  std::string of;  ///< axis, number or name that it is about; empty: all
};

struct Refusal {
  Rule rule{};
  double value{}, needed{};
};

[[nodiscard]] std::string_view word(Verdict verdict);
[[nodiscard]] std::string_view word(Cause cause);
[[nodiscard]] std::string_view word(Rule rule);

}  // namespace fathom::inference
