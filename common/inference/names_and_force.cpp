// What the names of a search are worth: against other names, and against the free force in their place.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/inference/searching.hpp"

namespace fathom::inference {
namespace {

constexpr double kPlain = 100.0;  // nats that a name is worth beyond all doubt: how much more is not asked

}  // namespace

void Searching::leave_out() {
  std::vector<Start> starts;
  for (std::size_t e = 0; e < effects().size(); ++e) {
    if (models_.best_of(names_without(e)) == nullptr) starts.push_back(without(found_.best, e));
  }
  const Odds odds{.from = found_.base.score, .to_beat = found_.best.score, .near = kPlain};
  if (!starts.empty() && goes_on()) models_.race(starts, odds);
}

FreeForceFound Searching::free_force_beside(const Fitted& fitted) const {
  begin(kFreeForceFit);
  FreeForceFound found =
      find_free_force(problem_, see(problem_, fitted.fit, threads_), scene_, thresholds_, threads_, deadline_);
  progress_.done(kFreeForceFit.phase);
  return found;
}

double Searching::worth(const FreeForceFound& force) { return std::max(0.0, force.log_odds); }

void Searching::give_way() {
  std::vector<std::size_t> order(effects().size()), weak;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t e) { return found_.odds[e]; });
  std::ranges::copy_if(order, std::back_inserter(weak),
                       [&](std::size_t e) { return found_.odds[e] < worth(*found_.free_force); });
  std::vector<model::ActiveEffect> asked;
  for (const std::size_t e : order) asked.push_back(effects()[e]);
  if (weak.size() > 1 && goes_on()) {
    Start start{found_.best.fit.hypothesis, found_.best.fit.noise};
    std::ranges::sort(weak, std::greater{});
    for (const std::size_t e : weak)
      start.hypothesis.model.effects.erase(start.hypothesis.model.effects.begin() + static_cast<std::ptrdiff_t>(e));
    const Fitted rest = models_.fit_all({start}).front();
    if (rest.fit.finite && goes_on()) takes_the_place(weak, rest);
  }
  for (const model::ActiveEffect& active : asked) {
    const auto place = std::ranges::find_if(
        effects(), [&](const auto& other) { return other.effect == active.effect && other.variant == active.variant; });
    if (place == effects().end()) continue;
    if (!goes_on()) return;
    const auto e = static_cast<std::size_t>(place - effects().begin());
    const Fitted* rest = models_.best_of(names_without(e));
    if (rest != nullptr) takes_the_place({e}, Fitted{*rest});
  }
}

void Searching::takes_the_place(const std::vector<std::size_t>& gone, const Fitted& rest) {
  FreeForceFound force = free_force_beside(rest);
  if (force.size.share < thresholds_.smallest_size) return;
  const double odds = found_.best.score + worth(*found_.free_force) - rest.score - worth(force);
  const bool stays = odds >= thresholds_.name_odds;
  for (const std::size_t e : gone) {
    const std::string name{effects()[e].effect->name()};
    if (!stays) gave_way_[name] = {Rule::kOdds, odds, thresholds_.name_odds};
    if (!stays || gone.size() > 1) continue;
    const auto [place, fresh] = in_place_.try_emplace(name, odds);
    if (!fresh) place->second = std::min(place->second, odds);
  }
  if (stays) return;
  found_.best = rest;
  found_.free_force = std::move(force);
  in_place_.clear();
  leave_out();
  judge_effects();
}

Size Searching::size_of(const Seen& seen, std::size_t effect, const Fitted* without) const {
  Size size = size_of_effect(problem_, seen, effect, threads_);
  for (std::size_t i = 0; without != nullptr && without->fit.finite && i < problem_.axes.size(); ++i) {
    const double with_it = seen.fit.noise[i][likelihood::kForce], instead = without->fit.noise[i][likelihood::kForce];
    const double applied = seen.applied[problem_.axes[i]];
    if (i >= static_cast<std::size_t>(problem_.simulated) || instead <= with_it || applied <= 0.0) continue;
    const double share = std::sqrt(instead * instead - with_it * with_it) / applied;
    if (share > size.share) size = {share, problem_.axes[i], share * applied / with_it};
  }
  return size;
}

void Searching::judge_effects() {
  found_.odds.clear();
  found_.size.clear();
  found_.over.clear();
  found_.probability.clear();
  found_.reliability.clear();
  found_.rival.clear();
  if (effects().empty()) return;
  const Seen seen = see(problem_, found_.best.fit, threads_);
  for (std::size_t e = 0; e < effects().size(); ++e) {
    const Size size = size_of(seen, e, models_.best_of(names_without(e)));
    found_.size.push_back(size.share);
    found_.over.push_back(size.over);
    const Standing standing =
        models_.standing(found_.best, found_.base.score, std::string(effects()[e].effect->name()), small_);
    found_.probability.push_back(standing.probability);
    const auto in_place = in_place_.find(std::string(effects()[e].effect->name()));
    found_.odds.push_back(in_place != in_place_.end() ? std::min(standing.odds, in_place->second) : standing.odds);
    found_.reliability.push_back(thresholds_.reliability(found_.odds.back()));
    found_.rival.push_back(standing.rival);
  }
}

void Searching::note(const Promise& promise) {
  auto [place, fresh] = noted_.try_emplace(laws_[promise.law].name, promise);
  if (!fresh && promise.score > place->second.score) place->second = promise;
  auto [of_form, new_form] = promised_.try_emplace(promise.law, promise);
  if (!new_form && promise.score > of_form->second.score) of_form->second = promise;
}

Refusal Searching::refusal(const std::string& name, double promised) const {
  const Fitted* best = models_.best_with(name);
  if (best == nullptr) {
    // Most of what a name promised before others were found has been theirs.
    const auto beside = beside_.find(name);
    return {Rule::kScore, beside != beside_.end() ? beside->second : promised, thresholds_.score_worth};
  }
  const double odds = best->fit.finite ? best->score - found_.best.score : -std::numeric_limits<double>::infinity();
  if (const auto gave_way = gave_way_.find(name); gave_way != gave_way_.end()) return gave_way->second;
  const auto failed = failed_.find(name);
  if (odds > 0.0 && failed != failed_.end()) return failed->second;
  if (!std::ranges::includes(best->names, found_.best.names))
    return {Rule::kProbability, 1.0 / (1.0 + std::exp(-odds)), thresholds_.name_probability};
  if (odds < thresholds_.name_odds) return {Rule::kOdds, odds, thresholds_.name_odds};
  return failed != failed_.end() ? failed->second : Refusal{Rule::kOdds, odds, thresholds_.name_odds};
}

void Searching::list_refused() {
  found_.refused.clear();
  for (const auto& [name, promise] : noted_) {
    if (std::ranges::find(found_.best.names, name) != found_.best.names.end()) continue;
    Refused refused{.name = name, .form = laws_[promise.law].form, .promised = promise.score};
    refused.refusals.push_back(refusal(name, promise.score));
    found_.refused.push_back(std::move(refused));
  }
  std::ranges::sort(found_.refused, std::greater{}, &Refused::promised);
}

}  // namespace fathom::inference
