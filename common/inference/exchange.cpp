// What goes again: names that others have made small or worthless, and names in whose place others are likelier.
#include <algorithm>

#include "common/base/factors.hpp"
#include "common/inference/searching.hpp"

namespace fathom::inference {

Start Searching::without(const Fitted& from, std::size_t effect) {
  Start start{from.fit.hypothesis, from.fit.noise};
  auto& effects = start.hypothesis.model.effects;
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(effect));
  return start;
}

double Searching::guessed_loss(const Seen& seen, std::size_t effect) const {
  const auto& active = seen.fit.hypothesis.model.effects[effect];
  const auto law = std::ranges::find_if(
      laws_, [&](const Law& one) { return one.seed.effect == active.effect && one.seed.variant == active.variant; });
  std::vector<Eigen::Index> places;
  std::vector<double> values;
  for (std::size_t j = 0; j < seen.fit.numbers.size(); ++j) {
    const likelihood::Number& number = seen.fit.numbers[j];
    if (number.kind != likelihood::NumberKind::kEffect || number.index != static_cast<int>(effect)) continue;
    if (law != laws_.end() &&
        std::ranges::find(law->linear, static_cast<std::size_t>(number.component)) == law->linear.end())
      continue;
    places.push_back(static_cast<Eigen::Index>(j));
    values.push_back(value(seen.fit.hypothesis, number));
  }
  if (places.empty()) return 0.0;
  const Eigen::MatrixXd covariance = seen.covariance(places, places);
  const Eigen::Map<const Eigen::VectorXd> theta{values.data(), static_cast<Eigen::Index>(values.size())};
  return 0.5 * theta.dot(solve_symmetric(covariance, theta));
}

void Searching::drop() {
  while (effects().size() > 1) {
    const Seen seen = see(problem_, found_.best.fit, threads_);
    std::vector<Start> small, weak;
    std::vector<std::size_t> which;
    for (std::size_t e = 0; e < effects().size(); ++e) {
      if (stopped(effects()[e], scene_) ||
          (!by_nature(effects()[e]) && size_of(seen, e, nullptr).share < thresholds_.smallest_size)) {
        small.push_back(without(found_.best, e));
        which.push_back(e);
      } else if (guessed_loss(seen, e) < kDoubtful * thresholds_.name_odds) {
        weak.push_back(without(found_.best, e));
      }
    }
    std::vector<Fitted> fits = models_.fit_all(small);
    for (std::size_t k = fits.size(); k-- > 0;) {
      if (stopped(effects()[which[k]], scene_) || size_of(seen, which[k], &fits[k]).share < thresholds_.smallest_size)
        continue;
      fits.erase(fits.begin() + static_cast<std::ptrdiff_t>(k));
      small.erase(small.begin() + static_cast<std::ptrdiff_t>(k));
    }
    if (small.empty()) fits = models_.fit_all(weak);
    const auto best = std::ranges::max_element(fits, {}, &Fitted::score);
    if (best == fits.end() || !best->fit.finite) return;
    // What stands by less than a name needs is no name.
    if (small.empty() && best->score + thresholds_.name_odds <= found_.best.score) return;
    std::vector<std::string> gone;
    std::ranges::set_difference(found_.best.names, best->names, std::back_inserter(gone));
    for (const std::string& name : gone) given_up_.emplace(best->names, name);
    found_.best = *best;
  }
}

bool Searching::given_up(const std::vector<std::string>& names) const {
  for (std::size_t k = 0; k < names.size() && !given_up_.empty(); ++k) {
    std::vector<std::string> others = names;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (given_up_.contains({std::move(others), names[k]})) return true;
  }
  return false;
}

std::vector<std::string> Searching::names_without(std::size_t effect) const {
  std::vector<std::string> others = found_.best.names;
  others.erase(std::ranges::find(others, effects()[effect].effect->name()));
  return others;
}

bool Searching::swap() {
  const std::size_t count = effects().size();
  if (count < 2) return false;
  bool exchanged = false;
  expect_rounds(static_cast<double>(count));
  for (std::size_t e = 0; e < effects().size(); ++e) {
    if (!goes_on()) break;
    const Fitted* without_it = models_.best_of(names_without(e));
    if (without_it == nullptr) continue;
    const Fitted rest = *without_it;
    const model::ActiveEffect active = effects()[e];
    // What stands in its place must do what it does.
    const double lost = found_.best.score - rest.score;
    std::vector<Proposal> proposed = proposals(rest, std::max(thresholds_.score_worth, kFarBehind * lost), false);
    std::erase_if(proposed, [&](const Proposal& proposal) { return proposal.added.front().effect == active.effect; });
    for (const Fitted& other :
         models_.race(starts(rest.fit.hypothesis, proposed), {.from = rest.score, .to_beat = found_.best.score})) {
      if (!other.fit.finite || other.score <= found_.best.score || !counts(other)) continue;
      found_.best = other;
      exchanged = true;
      in_place_.clear();
    }
    if (exchanged) leave_out();
  }
  return exchanged;
}

}  // namespace fathom::inference
