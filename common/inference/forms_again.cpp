// What was just found, once more: in its other forms, and at its other moments, frequencies and places.
#include <algorithm>

#include "common/inference/searching.hpp"

namespace fathom::inference {
namespace {

constexpr std::size_t kOtherForms = 4;  // of one effect, tried in its place
constexpr std::size_t kTimesAgain = 3;  // maxima of one effect from which it is fitted once more

}  // namespace

void Searching::simplify(const std::vector<model::ActiveEffect>& before) {
  const std::vector<model::ActiveEffect> now = effects();
  for (const model::ActiveEffect& active : now) {
    if (held(before, active) || !held(effects(), active)) continue;
    std::vector<std::size_t> forms;
    double promised = 0.0;
    for (const auto& [law, promise] : promised_) {
      if (laws_[law].seed.effect != active.effect) continue;
      promised = std::max(promised, promise.score);
      if (!held(now, laws_[law].seed)) forms.push_back(law);
    }
    std::erase_if(forms, [&](std::size_t law) { return promised_.at(law).score < 0.5 * promised; });
    std::ranges::sort(forms, std::greater{}, [&](std::size_t law) { return promised_.at(law).score; });
    forms.resize(std::min(forms.size(), kOtherForms));
    std::vector<Proposal> others;
    for (const std::size_t law : forms) {
      // From its own best and from the numbers that it shares with what was found.
      others.push_back({{effect_of(law, promised_.at(law).theta)}, found_.best.fit.noise});
      others.push_back({{laws_[law].seed}, found_.best.fit.noise});
      std::vector<double>& theta = others.back().added.front().theta;
      for (std::size_t c = 0; c < active.theta.size(); ++c) {
        if (moves(laws_[law].seed, c) && moves(active, c)) theta[c] = active.theta[c];
        if (!active.effect->is_told(laws_[law].seed.variant, c)) theta[c] = 0.0;
      }
    }
    likelihood::Hypothesis rest = found_.best.fit.hypothesis;
    std::erase_if(rest.model.effects,
                  [&](const auto& other) { return other.effect == active.effect && other.variant == active.variant; });
    for (const Fitted& other : models_.race(starts(rest, others), better())) {
      if (other.fit.finite && other.score > found_.best.score && counts(other)) found_.best = other;
    }
  }
}

Odds Searching::better() const { return {.from = found_.base.score, .to_beat = found_.best.score, .near = 0.0}; }

void Searching::seek_again(const std::vector<model::ActiveEffect>& before) {
  const std::vector<model::ActiveEffect> now = effects();
  for (const model::ActiveEffect& active : now) {
    const auto place = std::ranges::find_if(
        effects(), [&](const auto& other) { return other.effect == active.effect && other.variant == active.variant; });
    const auto law = std::ranges::find_if(
        laws_, [&](const Law& one) { return one.seed.effect == active.effect && one.seed.variant == active.variant; });
    if (held(before, active) || place == effects().end() || law == laws_.end() || !shaped(*law) || !goes_on()) continue;
    const Start rest = without(found_.best, static_cast<std::size_t>(place - effects().begin()));
    // As the noise is beside it.
    likelihood::Fit fit =
        likelihood::fit(problem_, rest.hypothesis, rest.noise,
                        {.noise_rounds = 1, .steps = 2, .enough = 1.0, .fit_noise = false, .threads = threads_});
    std::vector<Proposal> again;
    if (!fit.finite) continue;
    const auto look = [&](const Seen& seen) {
      for (std::vector<double>& theta : starts_of(problem_, seen, *law, kTimesAgain, thresholds_, threads_)) {
        again.push_back({{law->seed}, found_.best.fit.noise, false, {}});
        again.back().added.front().theta = std::move(theta);
      }
    };
    const Seen seen = see(problem_, fit, threads_);
    look(seen);
    // A moment, a place or a frequency that is a little off leaves a random force that hides it: seen with less of it
    // too.
    quiet(fit);
    look(see(problem_, fit, threads_));
    for (const Fitted& other : models_.race(starts(fit.hypothesis, again), better())) {
      if (other.fit.finite && other.score > found_.best.score && counts(other)) found_.best = other;
    }
  }
}

}  // namespace fathom::inference
