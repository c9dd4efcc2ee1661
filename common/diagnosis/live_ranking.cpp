// From evidence to a verdict.
#include <algorithm>
#include <cmath>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/live_diagnoser.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kModelDelay = 2.0;       // s: more than the identifier is late
constexpr std::size_t kMostModels = 100;  // of MODEL that are remembered
constexpr int kLongNamed = 5;             // rankings: the identifier has had them, and MODEL is back
constexpr double kExplainsMore = 0.05;    // of the error
// Too little of all axes for a name may be most of what one of them leaves: at twice the evidence of a name and half of
// what it must explain, something is at work. Trials without an effect stay below half of both (docs/live.md).
constexpr double kMoreEvidence = 2.0, kLessExplained = 0.5;
constexpr double kFarMore = 2.0, kFarLess = 1.0 / 3.0;  // times the error that the named one explains, and leaves

}  // namespace

/// A fault of a sensor comes first, and nothing else is accused beside it: the motion that accuses was measured by it.
EffectRanking LiveDiagnoser::rank(Utime utime) {
  EffectRanking ranking = by_forces(utime);
  std::vector<EffectEvidence> faults = sensors_.faults();
  std::erase_if(faults, [&](const EffectEvidence& fault) { return fault.log_odds < settings_.accept_log_odds; });
  if (faults.empty() || (ranking.verdict == "collecting" && !turning_)) {
    doubt(ranking);
    return ranking;
  }
  named_ = {};
  ranking.verdict = "effect";
  ranking.against.clear();
  rivals_.reset();
  ranking.candidates.insert(ranking.candidates.begin(), faults.begin(), faults.end());
  return ranking;
}

EffectRanking LiveDiagnoser::by_forces(Utime utime) {
  EffectRanking ranking{.utime = utime, .verdict = "collecting"};
  rivals_.reset();
  if (!screening_ || turning_) return ranking;
  LiveEvidence& evidence = screening_->evidence();
  if (evidence.blocks() < static_cast<std::size_t>(settings_.fewest_blocks)) return ranking;
  suspicions_ = evidence.judge();
  std::erase_if(suspicions_, [&](const LiveSuspicion& s) {
    const LiveForm& form = forms()[static_cast<std::size_t>(s.form)];
    if (form.effect->measures() && sensors_.velocity_judged()) return true;
    return screening_->places().rule_out(*form.effect, s.theta, form.variant);
  });
  // One whose search was stopped by a limit has found no numbers that could be true, whatever it imitates.
  const auto stopped = [&](const LiveSuspicion& s) {
    const LiveForm& form = forms()[static_cast<std::size_t>(s.form)];
    return model::stopped_at_limit(*form.effect, form.variant, s.theta, *vehicle_);
  };
  const auto convinces = [&](const LiveSuspicion& s) {
    return s.log_odds >= settings_.accept_log_odds && s.error_reduction >= settings_.smallest_reduction && !stopped(s);
  };
  // Odds say whether; among those that convince, the one that explains most comes first.
  const auto doubtful = std::stable_partition(suspicions_.begin(), suspicions_.end(), convinces);
  std::stable_sort(suspicions_.begin(), doubtful, [](const LiveSuspicion& a, const LiveSuspicion& b) {
    return a.error_reduction > b.error_reduction;
  });
  if (doubtful != suspicions_.begin()) prefer_plain();
  const auto effect_of = [&](const LiveSuspicion& s) { return forms()[static_cast<std::size_t>(s.form)].effect; };
  std::vector<const LiveSuspicion*> best;  // of each effect, in order
  for (const LiveSuspicion& suspicion : suspicions_) {
    const bool known = std::any_of(best.begin(), best.end(),
                                   [&](const LiveSuspicion* b) { return effect_of(*b) == effect_of(suspicion); });
    if (known) continue;
    best.push_back(&suspicion);
    ranking.candidates.push_back({.name = std::string{effect_of(suspicion)->name()},
                                  .log_odds = suspicion.log_odds,
                                  .error_reduction = suspicion.error_reduction,
                                  .variant = forms()[static_cast<std::size_t>(suspicion.form)].variant_name,
                                  .numbers = suspicion.theta});
  }
  if (best.empty() || !convinces(*best.front())) {
    const bool something = std::ranges::any_of(suspicions_, [&](const LiveSuspicion& s) {
      return s.log_odds >= kMoreEvidence * settings_.accept_log_odds &&
             s.error_reduction >= kLessExplained * settings_.smallest_reduction;
    });
    ranking.verdict = something || evidence.structured() || leaves_much(utime) ? "unexplained" : "adequate";
    return ranking;
  }
  const LiveSuspicion& winner = *best.front();
  // What a stopped one imitates so much better is at work, and has no name here: the winner explains something beside
  // it.
  const bool beside = std::ranges::any_of(suspicions_, [&](const LiveSuspicion& s) {
    const bool far = s.error_reduction > kFarMore * winner.error_reduction ||
                     1.0 - s.error_reduction < kFarLess * (1.0 - winner.error_reduction);
    return far && s.log_odds >= settings_.accept_log_odds && stopped(s);
  });
  if (beside) {
    ranking.verdict = "unexplained";
    return ranking;
  }
  // Of the residual's power.
  const auto explained = [](const LiveSuspicion& s) { return 1.0 - std::pow(1.0 - s.error_reduction, 2); };
  const auto rival = std::find_if(best.begin() + 1, best.end(), [&](const LiveSuspicion* other) {
    // No name is safe while another explains more, and most of the same with it, though it may not convince by itself.
    const bool more = other->error_reduction > winner.error_reduction && !stopped(*other);
    if (!more && !convinces(*other)) return false;
    const double wider = more ? std::sqrt(explained(*other) / explained(winner)) : 1.0;
    return wider * evidence.likeness(winner, *other) > settings_.alias_correlation &&
           robust_log_likelihood_ratio(other->block_cost, winner.block_cost) < settings_.alternative_log_odds;
  });
  if (rival == best.end()) {
    // Forms of one effect are hardly told apart by tangents: one that convinces and has a look-alike is enough.
    for (const LiveSuspicion& form : suspicions_) {
      if (effect_of(form) != effect_of(winner) || !convinces(form) || !ranking.against.empty()) continue;
      const int variant = forms()[static_cast<std::size_t>(form.form)].variant;
      ranking.against = effect_of(form)->looks_like(form.theta, variant, screening_->scene()).what;
    }
    ranking.verdict = ranking.against.empty() ? "effect" : "ambiguous";
    return ranking;
  }
  const auto active = [&](const LiveSuspicion& s) {
    const LiveForm& form = forms()[static_cast<std::size_t>(s.form)];
    return model::ActiveEffect{form.effect, form.variant, form.variant_name, s.theta};
  };
  ranking.verdict = "ambiguous";
  ranking.against = effect_of(**rival)->name();
  // No segment is rehearsed with a wrong sensor.
  if (!effect_of(winner)->measures() && !effect_of(**rival)->measures())
    rivals_.emplace(active(winner), active(**rival));
  return ranking;
}

// The ordinary form of an effect, which has no name, stands for every other from which blocks do not tell it: two forms
// of a lag change places with every block, and mean the same.
void LiveDiagnoser::prefer_plain() {
  const auto form_of = [&](const LiveSuspicion& s) { return forms()[static_cast<std::size_t>(s.form)]; };
  const LiveForm best = form_of(suspicions_.front());
  const auto plain = std::ranges::find_if(suspicions_, [&](const LiveSuspicion& s) {
    const LiveForm form = form_of(s);
    return form.effect == best.effect && form.variant_name.empty() &&
           form.effect->numbers(form.variant) <= best.effect->numbers(best.variant);
  });
  if (plain == suspicions_.end() || plain->log_odds < settings_.accept_log_odds ||
      plain->error_reduction < settings_.smallest_reduction)
    return;
  if (robust_log_likelihood_ratio(plain->block_cost, suspicions_.front().block_cost) < settings_.alternative_log_odds)
    std::rotate(suspicions_.begin(), plain, plain + 1);
}

// What is named again and again is adopted, unless it leaves a residual: then the name explains something of it, and is
// not what is missing. It is believed anew when it has come to explain more.
void LiveDiagnoser::doubt(EffectRanking& ranking) {
  if (ranking.verdict != "effect") return;
  const EffectEvidence& best = ranking.candidates.front();
  const std::string what = best.name + " " + best.variant;
  if (what != named_.what || best.error_reduction > named_.explains + kExplainsMore)
    named_ = {what, best.error_reduction, 0};
  ++named_.times;
  if (named_.times <= kLongNamed || !leaves_much(ranking.utime)) return;
  const std::vector<std::string>& adopted = model_before(ranking.utime)->effects;
  if (std::ranges::find(adopted, best.name) == adopted.end()) ranking.verdict = "unexplained";
}

void LiveDiagnoser::hear(const ModelEstimate& model) {
  if (!left_.empty() && model.utime <= left_.back().utime) return;
  if (left_.empty() || left_.back().effects != model.effects) ratio_ = {.begin = model.utime};
  // While numbers are still found, a residual is too large in any trial.
  if (seconds_between(ratio_.begin, model.utime) >= settings_.warm_up) {
    ratio_.sum += model.residual_ratio;
    ++ratio_.count;
  }
  const double always = (ratio_.sum / std::max(ratio_.count, 1)).maxCoeff();
  left_.push_back({model.utime, std::max(model.residual_ratio.maxCoeff(), always), model.effects});
  if (left_.size() > kMostModels) left_.pop_front();
}

// Models count by their time stamps, kModelDelay after them, so that it does not matter when they arrived.
const LiveDiagnoser::Left* LiveDiagnoser::model_before(Utime utime) const {
  const auto last = std::find_if(left_.rbegin(), left_.rend(),
                                 [&](const Left& left) { return seconds_between(left.utime, utime) >= kModelDelay; });
  return last == left_.rend() ? nullptr : &*last;
}

// A residual that forgets within a second shows no memory here, but its power gives it away; and one that was too large
// and is small for now has not got what it lacked, unless something was adopted.
bool LiveDiagnoser::leaves_much(Utime utime) const {
  const Left* model = model_before(utime);
  return settings_.largest_ratio > 0.0 && model != nullptr && model->ratio > settings_.largest_ratio;
}

void LiveDiagnoser::forget_motion() {
  seen_.clear();
  all_seen_ = true;
  screening_.reset();
  wider_.reset();
  turning_ = false;
  named_ = {};
  commands_end_.reset();
}

void LiveDiagnoser::reset() {
  forget_motion();
  newest_ = 0;
  source_ = Source::kUnknown;
  aligner_.reset();
  left_.clear();
  ratio_ = {};
  sensors_.reset();
  turned_ = {};
  suspicions_.clear();
  rivals_.reset();
}

}  // namespace fathom::diagnosis
