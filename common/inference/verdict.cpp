#include "common/inference/verdict.hpp"

namespace fathom::inference {

std::string_view word(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return "adequate";
    case Verdict::effect:
      return "effect";
    case Verdict::ambiguous:
      return "ambiguous";
    case Verdict::unexplained:
      return "unexplained";
    case Verdict::no_model:
      return "no_model";
    case Verdict::not_judged:
      return "not_judged";
  }
  return "not_judged";
}

std::string_view word(Cause cause) {
  switch (cause) {
    case Cause::kNothingFound:
      return "nothing_found";
    case Cause::kNamed:
      return "named";
    case Cause::kRivals:
      return "rivals";
    case Cause::kWeakEvidence:
      return "weak_evidence";
    case Cause::kFreeForce:
      return "free_force";
    case Cause::kSlowRandomForce:
      return "slow_random_force";
    case Cause::kManyNames:
      return "many_names";
    case Cause::kNotFollowing:
      return "not_following";
    case Cause::kNoSkill:
      return "no_skill";
    case Cause::kWiring:
      return "wiring";
    case Cause::kForceUnit:
      return "force_unit";
    case Cause::kInputIdle:
      return "input_idle";
    case Cause::kAbsurdNumber:
      return "absurd_number";
    case Cause::kTooShort:
      return "too_short";
    case Cause::kNotFinite:
      return "not_finite";
    case Cause::kOutOfTime:
      return "out_of_time";
    case Cause::kSensorsDisagree:
      return "sensors_disagree";
    case Cause::kSensorsUndecided:
      return "sensors_undecided";
    case Cause::kBeginsUnseen:
      return "begins_unseen";
    case Cause::kNamesMislead:
      return "names_mislead";
    case Cause::kScoresDisagree:
      return "scores_disagree";
  }
  return "not_finite";
}

std::string_view word(Rule rule) {
  switch (rule) {
    case Rule::kOdds:
      return "odds";
    case Rule::kSize:
      return "size";
    case Rule::kProbability:
      return "probability";
    case Rule::kBound:
      return "bound";
    case Rule::kScore:
      return "score";
  }
  return "score";
}

}  // namespace fathom::inference
