#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/verdict/by_likelihood.hpp"
#include "common/verdict/lists.hpp"

namespace fathom::verdict {
namespace {

using inference::Cause;
using inference::Conclusion;
using inference::Reason;
using inference::Verdict;

template <typename... Arguments>
std::string text(const char* format, Arguments... arguments) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, arguments...);
  return buffer;
}

std::string percent(double share) { return text("%.*f %%", share < 0.1 ? 1 : 0, 100.0 * share); }

std::string title(std::string name) {
  if (name.starts_with("column ")) return name;  // as its owner wrote it
  std::ranges::replace(name, '_', ' ');
  return name;
}

/// Those that are as sure as a claim must be, those that are not, or all.
enum class Which { kAll, kSure, kDoubtful };
std::string names(const Conclusion& conclusion, Which which = Which::kAll) {
  std::string all;
  const inference::Found& found = conclusion.found;
  const auto& effects = found.best.fit.hypothesis.model.effects;
  for (const std::size_t e : surest_first(found)) {
    const bool sure = inference::by_nature(effects[e]) ||
                      found.probability[e] * found.reliability[e] >= inference::Thresholds{}.name_probability;
    if (which != Which::kAll && sure != (which == Which::kSure)) continue;
    const double odds = conclusion.found.odds[e];
    all += (all.empty() ? "" : ", ") + title(std::string(effects[e].effect->name()));
    if (!effects[e].variant_name.empty()) all += " (" + effects[e].variant_name + ")";
    all += ": " + percent(conclusion.found.size[e]) + " of the applied force";
    all += text(", log odds %.0f", odds);
  }
  return all;
}

/// Without odds, which mean nothing beside something unlisted.
std::string stand_ins(const Conclusion& conclusion) {
  std::string all;
  const inference::Found& found = conclusion.found;
  const auto& effects = found.best.fit.hypothesis.model.effects;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    all += (e > 0 ? ", " : "") + title(std::string(effects[e].effect->name()));
    if (!effects[e].variant_name.empty()) all += " (" + effects[e].variant_name + ")";
    all += ": " + percent(found.size[e]) + " of the applied force";
    const double over = found.over[e];
    if (over > 0.0) all += text(", %.*f times what is left there", over < 1.0 ? 2 : over < 10.0 ? 1 : 0, over);
  }
  return all;
}

const Reason* reason(const Conclusion& conclusion, Cause cause) {
  const auto found = std::ranges::find(conclusion.reasons, cause, &Reason::cause);
  return found != conclusion.reasons.end() ? &*found : nullptr;
}

std::string random_forces(const Conclusion& conclusion) {
  std::string sentence = "Random force beside the model, share of the applied force and memory:";
  for (const inference::RandomForce& force : conclusion.random)
    sentence += text(" %s %s, %.1f s;", model::kAxisNames[static_cast<std::size_t>(force.axis)],
                     percent(force.share).c_str(), force.memory);
  sentence.back() = '.';
  return sentence;
}

std::string unexplained(const Conclusion& conclusion) {
  std::string sentence;
  if (const Reason* free = reason(conclusion, Cause::kFreeForce)) {
    sentence += text("Something acts that no listed effect explains: %s of the applied force in %s",
                     percent(conclusion.found.free_force->size.share).c_str(),
                     model::kAxisNames[static_cast<std::size_t>(conclusion.found.free_force->size.axis)]) +
                (std::isfinite(free->value) ? text(", log odds %.0f", free->value)
                                            : std::string{", by a first look that there was no time to confirm"}) +
                ". It goes with " + free->of + ". These are its arguments, not its cause. ";
  }
  if (const Reason* slow = reason(conclusion, Cause::kSlowRandomForce)) {
    sentence += text("A force in %s remembers itself for %.0f s: that is no noise, and nothing recorded goes with it. ",
                     slow->of.c_str(), slow->value);
  }
  if (const Reason* many = reason(conclusion, Cause::kManyNames)) {
    sentence +=
        many->value > many->threshold
            ? text(
                  "%.0f listed effects at once leave something all the same: something unlisted is likelier than "
                  "all of them. ",
                  many->value)
            : text(
                  "It takes %.0f listed effects to describe these runs, as many as were tried: something "
                  "unlisted may be behind all of them. ",
                  many->value);
  }
  if (const Reason* misled = reason(conclusion, Cause::kNamesMislead)) {
    sentence += text(
        "What fits best here foretells the runs that judge worse than the model without it does, by %.0f %%: it stands "
        "in for something else, or it was otherwise there. ",
        -100.0 * misled->value);
  }
  if (const Reason* event = reason(conclusion, Cause::kBeginsUnseen)) {
    sentence += text("Something begins near %.3g s of %s, which judges: no fit has seen it, and it is not explained. ",
                     event->value, event->of.c_str());
  }
  return sentence;
}

/// What was measured of why, likeliest first.
std::string reasons_of_no_model(const Conclusion& conclusion) {
  if (const Reason* wiring = reason(conclusion, Cause::kWiring))
    return text("likeliest because of the wiring: %s takes %.0f %% of the error away. ", wiring->of.c_str(),
                100.0 * wiring->value);
  if (const Reason* unit = reason(conclusion, Cause::kForceUnit))
    return text("likeliest thrust is in another unit: inertias come out %.3g times what the file expects. ",
                unit->value);
  std::string idle, reversed;
  for (const Reason& one : conclusion.reasons) {
    if (one.cause != Cause::kInputIdle) continue;
    std::string& axes = one.value < -one.threshold ? reversed : idle;
    axes += (axes.empty() ? "" : ", ") + one.of;
  }
  if (!reversed.empty()) return "likeliest because the recorded thrust pushes the other way along " + reversed + ". ";
  const bool learned = std::ranges::any_of(conclusion.reasons, [](const Reason& one) { return one.of == kLearned; });
  if (!idle.empty())
    return "likeliest because the recorded thrust does not act along " + idle +
           (learned ? ", or because the force that was learned opposes it: these runs do not tell. " : ". ");
  if (learned) return "likeliest because of the force that was learned. ";
  if (const auto& free = conclusion.found.free_force; free && free->log_odds > inference::Thresholds{}.free_force_odds)
    return "wiring, force unit and inputs are in order: terms of the hull are missing. ";
  return "wiring, force unit and inputs are in order as far as this data tells. ";
}

/// What is in no list and fits as well, however good the data of these runs.
std::string look_alikes(const Conclusion& conclusion) {
  std::string words;
  for (const inference::LookAlike& one : conclusion.look_alikes)
    words += "What is called " + title(one.of) + " may be " + one.what +
             " as well, of which these data say nothing: what tells is " + one.told_by + ". ";
  return words;
}

}  // namespace

std::string sentence(const inference::Refusal& refusal) {
  using inference::Rule;
  switch (refusal.rule) {
    case Rule::kOdds:
      if (std::isinf(refusal.value)) return "no fit with it came to an end";
      return text("log odds %.1f, %.0f needed", refusal.value, refusal.needed);
    case Rule::kSize:
      return text("%.2g %% of the applied force, %.0f %% needed", 100.0 * refusal.value, 100.0 * refusal.needed);
    case Rule::kProbability:
      return text("probability %.2g beside other names, %.2g needed", refusal.value, refusal.needed);
    case Rule::kBound:
      return "fits only with a number at its limit";
    case Rule::kScore:
      if (refusal.value >= refusal.needed) return text("promises %.1f nats, others more", refusal.value);
      return text("promises %.1f nats, %.0f needed to be fitted", refusal.value, refusal.needed);
  }
  return {};
}

std::string paragraph(const Conclusion& conclusion) {
  std::string words;
  switch (conclusion.verdict) {
    case Verdict::adequate:
      words = "Nothing of practical size is missing that this data can show. ";
      break;
    case Verdict::effect:
      words = "Found: " + names(conclusion) + ". " + look_alikes(conclusion);
      break;
    case Verdict::ambiguous: {
      const std::string why = reason(conclusion, Cause::kWeakEvidence) != nullptr ? "the evidence for a name is weak"
                                                                                  : "more than one name fits it";
      const std::string sure = names(conclusion, Which::kSure), doubtful = names(conclusion, Which::kDoubtful);
      words = sure.empty() || doubtful.empty()
                  ? "Something is missing, and " + why + ". Likeliest: " + names(conclusion) + ". "
                  : "Found: " + sure + ". More is missing, and " + why + ". Likeliest: " + doubtful + ". ";
      for (const std::string& rival : conclusion.found.rival) {
        if (!rival.empty()) words += "It may be " + title(rival) + " as well. ";
      }
      words += look_alikes(conclusion);
      break;
    }
    case Verdict::unexplained:
      words = unexplained(conclusion);
      if (!conclusion.found.best.names.empty())
        words +=
            "Listed effects that stand in for a part of it, without a claim that they act: " + stand_ins(conclusion) +
            ". ";
      break;
    case Verdict::no_model:
      words = "The model does not follow its thrust everywhere, and the numbers of such axes are withheld: ";
      for (const Reason& one : conclusion.reasons) {
        if (one.cause == Cause::kNotFollowing)
          words += text("along %s it explains %.0f %% of the acceleration; ", one.of.c_str(), 100.0 * one.value);
        if (one.cause == Cause::kNoSkill)
          words += text("along %s it foretells 5 s worse than saying that nothing changes; ", one.of.c_str());
        if (one.cause == Cause::kAbsurdNumber) words += one.of + " is no number that this vehicle can have; ";
      }
      words += reasons_of_no_model(conclusion);
      break;
    case Verdict::not_judged: {
      const Reason* shortness = reason(conclusion, Cause::kTooShort);
      if (shortness != nullptr) {
        words =
            text("Nothing is judged: %.0f s of data, and %.0f s are needed. ", shortness->value, shortness->threshold);
      } else if (reason(conclusion, Cause::kNotFinite) != nullptr) {
        words = "Nothing is judged: the filter did not run through this data. ";
      }
    }
  }
  if (reason(conclusion, Cause::kOutOfTime) != nullptr)
    words += "The time was over before every effect had been asked: allow more, or give less data. ";
  if (const Reason* off = reason(conclusion, Cause::kScoresDisagree)) {
    words += text(
        "The numbers are those that predict ten seconds: they err %.0f %% less there than those that predict one step "
        "best, so the model errs in a way that no noise explains. ",
        100.0 * off->value);
  }
  if (!conclusion.random.empty()) words += random_forces(conclusion) + " ";
  if (conclusion.verdict == Verdict::effect || conclusion.verdict == Verdict::adequate)
    words += "Intervals hold only if the model does.";
  return words;
}

std::string what_swings(std::span<const AxisWhiteness> left) {
  std::string axes;
  for (const AxisWhiteness& axis : left) {
    if (axis.swings())
      axes += text("%s %s every %.1f s", axes.empty() ? "" : ",", axis.axis.c_str(), axis.swing_period_s);
  }
  return axes.empty() ? "" : " What is left swings:" + axes + ", as by " + std::string{kWhatSwings} + ".";
}

}  // namespace fathom::verdict
