#include "common/diagnosis/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/diagnosis/foretold.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/left_over.hpp"
#include "common/diagnosis/listing.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/diagnosis/rivals.hpp"
#include "common/diagnosis/words.hpp"
#include "common/preflight/applicability.hpp"
#include "common/residual/whiteness.hpp"

namespace fathom::diagnosis {
namespace {

const double kStrong = std::log(20.0);  // odds that a name is right; with less it is the likeliest, not shown

std::string improvement_sentence(const DiagnosisResult& result) {
  const Interval& change = result.improvement;
  const bool own = !result.own_in_validation.empty();
  std::string text = own ? "The validation run has numbers of its own for " + joined(result.own_in_validation) +
                               " (when, in what phase, or which way the water goes); its first half set them. In its "
                               "second half the 5 s prediction error "
                         : "On runs that no fit has seen, the 5 s prediction error ";
  text += std::string(change.value >= 0.0 ? "falls by " : "grows by ") + percent(std::abs(change.value));
  if (std::isfinite(change.low) && std::isfinite(change.high)) {
    text += " (95 % interval " + percent(change.low) + " to " + percent(change.high) + ")";
  } else {
    text += " (too little validation data for an interval)";
  }
  return text + ". ";
}

/// Of a residual that is no structure, and not white either.
std::string memory_sentence(const DiagnosisResult& result) {
  std::vector<std::string> axes;
  double longest = 0.0;
  for (const AxisWhiteness& axis : result.residual_after) {
    if (!(axis.p_value < kNotRandom) || axis.autocorrelation_time_s < kNoMemory) continue;
    axes.push_back(axis.axis);
    longest = std::max(longest, axis.autocorrelation_time_s);
  }
  if (axes.empty()) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.2g s", longest);
  return "In " + joined(axes) + " it remembers itself, for up to " + text +
         ": like a random force, as of turbulence or of a swinging tether, that no model foretells; what nothing "
         "recorded "
         "goes with would look the same. ";
}

/// The accepted number that is known worst, relative to its size.
struct WeakestNumber {
  const EffectFound* effect{};
  std::string name;
  double share{};  // standard deviation over size
};

WeakestNumber weakest_number(const DiagnosisResult& result) {
  WeakestNumber weakest;
  for (const EffectFound& effect : result.effects) {
    for (const NamedValue& number : effect.parameters) {
      const double share = number.value != 0.0 ? number.std / std::abs(number.value) : 0.0;
      if (!std::isfinite(share) || (weakest.effect != nullptr && share <= weakest.share)) continue;
      weakest = {&effect, number.name, share};
    }
  }
  return weakest;
}

std::string wiring_sentence(const WiringFault& fault) {
  return "The thrusters do not seem to be those of the vehicle's file: with " + joined(fault.readings, ", or with ") +
         ", the base model fitted anew would make " + percent(fault.error_reduction) +
         " less error. No effect is named before the file is right: try the thrusters one by one, correct it, "
         "or the axes of the recordings, and diagnose again. ";
}

bool is_open(const EffectFound& effect) { return !effect.alternatives.empty() || !effect.unlisted.empty(); }

/// All that the effect may be instead.
std::vector<std::string> instead_of(const EffectFound& effect) {
  std::vector<std::string> others;
  for (const Alternative& other : effect.alternatives) others.push_back(other.name);
  if (!effect.unlisted.empty()) others.push_back(effect.unlisted);
  return others;
}

std::string motion_for(const std::string& name) { return std::string(model::find_effect(name)->revealed_by()); }

/// What to drive next: what tells look-alikes apart, else what sharpens the weakest number, else what would confirm
/// or rule out the nearest candidate. Empty when nothing is open.
std::string next_manoeuvre(const DiagnosisResult& result, const Judged* promising) {
  for (const EffectFound& effect : result.effects) {
    if (!is_open(effect)) continue;
    std::vector<std::string> motions;
    if (!effect.unlisted.empty()) motions.push_back(effect.unlisted_told_by);
    if (!effect.alternatives.empty()) motions.push_back(motion_for(effect.name));
    for (const Alternative& other : effect.alternatives) {
      const std::string motion = motion_for(other.name);
      if (std::find(motions.begin(), motions.end(), motion) == motions.end()) motions.push_back(motion);
    }
    return "To tell " + effect.name + " from " + joined(instead_of(effect)) + ": " + joined(motions, "; and ") + ".";
  }
  const WeakestNumber weakest = weakest_number(result);
  if (weakest.effect != nullptr) {
    return "To know " + weakest.effect->name + " better (its " + weakest.name + " is known to " +
           percent(weakest.share) + "): " + motion_for(weakest.effect->name) + ".";
  }
  if (promising != nullptr) {
    const std::string name{promising->effect->name()};
    return "To confirm or rule out " + name + ": " + motion_for(name) + ".";
  }
  if (result.verdict != "unexplained" || result.candidates.empty()) return "";
  const CandidateTried& nearest = result.candidates.front();
  if (nearest.error_reduction <= 0.0) return "";
  return "To confirm or rule out the nearest candidate, " + nearest.name + ": " + motion_for(nearest.name) + ".";
}

/// What a program lists among the refused, and whose name may be right all the same.
std::string taken_back_sentence(const SearchResult& found) {
  std::vector<std::string> names;
  for (const Judged& judged : found.refused) {
    if (judged.reason == kNotCarriedOver) names.emplace_back(judged.effect->name());
  }
  return joined(names) + " helped the training runs and did not help the validation run" +
         (names.empty() ? "" : ": if it acts otherwise in every run, let one long run be judged by its own end") + ". ";
}

/// Odds by which noise with a memory, that a pilot answers, has favoured an effect: an answer on other runs is then the
/// better witness that there is none.
constexpr double kByChance = 8.0;

/// True where the axes only turn, and speeds that were not measured give moments (v x diag(m_X, m_Y, m_Z) v): what is
/// left need not be the thrusters' fault.
bool munk_moments_unknown(const model::Scene& scene, std::span<const std::string> axes) {
  const auto& dof = scene.vehicle->dof;
  const bool moves = static_cast<int>(dof[0]) + static_cast<int>(dof[1]) + static_cast<int>(dof[2]) >= 2;
  return moves && !scene.velocity &&
         std::ranges::all_of(axes, [](const std::string& axis) { return axis == "K" || axis == "M" || axis == "N"; });
}

/// As much of a whole cause as what stands beside a random force may be: nine to one.
constexpr double kInNoise = 0.99;

/// Whether the effects are evident beside a random force, which is all that is left beside them.
bool stand_in_noise(const SearchResult& found) {
  return found.explained >= kMostOfIt && found.explained_of_structure >= kWholeCause &&
         std::ranges::all_of(found.accepted, [](const Judged& judged) { return judged.beside_memory >= kByChance; });
}

/// The refused effect that would save most of the error; none when that is little, or when the validation run has just
/// told that it saves nothing there.
const Judged* promising_of(const SearchResult& found) {
  const auto most = std::ranges::max_element(found.refused, {}, &Judged::error_reduction);
  if (most == found.refused.end() || found.taken_back) return nullptr;
  const auto windows = static_cast<double>(std::max<std::size_t>(found.after.window_cost.size(), 1));
  return most->error_reduction >= kPromising + 1.0 / windows ? &*most : nullptr;
}

}  // namespace

void conclude(const SearchResult& found, std::span<const Association> left, const model::Scene& scene,
              DiagnosisResult& result, const std::string& unjudged) {
  result.explained = found.accepted.empty() ? 1.0 : found.explained;
  result.goes_with.assign(left.begin(), left.end());
  const std::vector<Foretold> foretold = badly_foretold(result);
  // Worse than to assume the average: whatever is at work, the model does not explain it.
  const bool blind = std::ranges::any_of(foretold, &Foretold::blind);
  const Judged* promising = promising_of(found);
  // Noise beside which thrust hardly matters is no model that explains the runs.
  const std::vector<std::string> astray_axes = not_followed(result, foretold);
  const bool structure = !left.empty() || found.free_form || found.taken_back.value_or(0.0) > kByChance || blind ||
                         !astray_axes.empty() || promising != nullptr || result.wiring;
  const bool in_noise = !structure && found.explained < kWholeCause && stand_in_noise(found);
  list_effects(found, in_noise ? kInNoise : found.explained, scene, result);
  const std::size_t asked = list_candidates(found, scene, result);
  result.not_measured = not_measured(scene);
  std::vector<std::string> names, open;
  for (const EffectFound& effect : result.effects) {
    names.push_back(effect.name);
    if (is_open(effect)) open.push_back(effect.name + " (or " + joined(instead_of(effect), " or ") + ")");
  }
  const bool in_part = !names.empty() && found.explained < kWholeCause && !in_noise;
  const bool idle = !names.empty() && foretells_nothing(result, scene, found.after.sigma);
  const bool stand_ins = in_part || idle;
  if (idle) {
    for (EffectFound& effect : result.effects) effect.log_odds = std::min(effect.log_odds, 0.0);
  }
  if (names.empty()) {
    result.verdict = structure ? "unexplained" : unjudged.empty() ? "adequate" : "unjudged";
  } else if (stand_ins) {
    result.verdict = "unexplained";
  } else {
    result.verdict = open.empty() ? "effect" : "ambiguous";
  }

  std::string& text = result.paragraph;
  if (result.wiring) {
    text = wiring_sentence(*result.wiring);
    result.manoeuvre = "Run each thruster alone for a second or two and see which way the vehicle goes.";
    return;
  }
  if (result.verdict == "unjudged") {
    text = "None of the " + std::to_string(asked) +
           " effects that were tried has evidence worth adding, which says little here. " + unjudged;
  } else if (names.empty() && !structure) {
    text =
        "The base model explains these runs: none of the " + std::to_string(asked) +
        " effects that were tried has evidence worth adding, and what is left goes with nothing that was measured. " +
        memory_sentence(result);
    if (found.taken_back) text += "One that seemed to help the training runs did not help the validation run. ";
  } else if (names.empty()) {
    text = "The base model leaves structure in the residual that no known effect explains. ";
    if (found.taken_back) text += taken_back_sentence(found);
    text += unjudged;
  } else {
    const double odds = std::ranges::min_element(result.effects, {}, &EffectFound::log_odds)->log_odds;
    text = stand_ins        ? "The base model lacks something, a part of which these effects imitate: "
           : odds < kStrong ? "Most likely the base model lacks: "
                            : "The motion shows what the base model lacks: ";
    text += joined(names) + ". ";
    for (const EffectFound& effect : result.effects) {
      text += effect.sentence + " ";
      if (!effect.other_forms.empty())
        text += "Which form of " + effect.name + " it is remains open: " + joined(effect.other_forms, "; ") + ". ";
    }
    text += unjudged.empty() ? improvement_sentence(result) : unjudged;
    if (in_noise) text += "What is left goes with nothing that was measured. " + memory_sentence(result);
  }
  text += foretold_sentence(foretold);
  if (result.verdict == "adequate" && foretold.empty()) text += hardly_shown_sentence(result);
  if (!astray_axes.empty()) {
    text += "Along " + joined(astray_axes) + " less than half of the applied force is accounted for: " +
            (munk_moments_unknown(scene, astray_axes)
                 ? "without velocities the moments of moving through the water are not known, which may be all of it. "
                 : "are the thrusters' order, signs, places and units those of the vehicle's file? ");
  }
  if (idle) {
    text +=
        "With that, too, the model foretells no motion along any axis: did the thrusters run, and did the vehicle move "
        "more than its sensors' noise? ";
  }
  if (in_part) {
    text += "Where " + joined(names) + " act" + (names.size() > 1 ? "" : "s") + ", only " + percent(found.explained) +
            " of the error that outlasts the noise is gone; a whole cause removes nearly all of it. So " +
            (names.size() > 1 ? "these may stand in" : "it may stand in") +
            " for something that no known effect describes: kept because the prediction gains, not as a certain name. ";
  }
  if (!open.empty()) {
    for (const EffectFound& effect : result.effects) text += odds_sentence(effect);
    text += "On this data " + joined(open) + " cannot be told apart";
    const auto first = std::ranges::find_if(result.effects, is_open);
    text += "; what would settle it: " + (first->unlisted.empty() ? motion_for(first->name) : first->unlisted_told_by);
    text += ". ";
  }
  if (promising != nullptr) {
    text += std::string(promising->effect->name()) + " would remove " + percent(promising->error_reduction) +
            " of the error, and is not certain: " + promising->reason + ". ";
  }
  if (found.free_form) {
    text += "A force on " + found.free_form->axis + " that depends on " + found.free_form->with +
            " in a way that no known effect has would remove " + percent(found.free_form->share) +
            " of the error that is left. ";
  }
  if (!left.empty()) {
    std::vector<std::string> words;
    for (const Association& association : left.first(std::min<std::size_t>(left.size(), 3))) {
      words.push_back(association.axis + " with " + association.with + " (" + percent(association.share) +
                      " of its variance)");
    }
    text += "What is still left in the residual goes with: " + joined(words) + ". ";
  }
  text += not_measured_sentences(result.not_measured, *scene.vehicle);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  result.manoeuvre = next_manoeuvre(result, promising);
}

}  // namespace fathom::diagnosis
