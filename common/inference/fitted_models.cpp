#include "common/inference/fitted_models.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/parallel.hpp"
#include "common/likelihood/fitting.hpp"

namespace fathom::inference {
namespace {

constexpr std::array kCountPrior{0.5, 0.3, 0.13, 0.05, 0.012, 0.005, 0.002, 0.0007, 0.0003};  // of 0 to 8 effects
constexpr double kOwnFlowPrior = 0.5;  // of a form of what craft that live by their flow have
constexpr double kNever = -1e300;      // score of what could not be fitted

// A round of the numbers and the noise tells a candidate's rank; only what may still win goes on. What has not gained
// half of what the best has, and is not near it, has never won afterwards.
// A fit ends when a round gains no nat any more, not after so many: where numbers and noise move each other slowly
// (drag of third order beside a random force: a hundred nats a round), a fit that is cut short is beaten by anything.
constexpr int kMostRounds = 20;
constexpr likelihood::FitOptions kThorough{.noise_rounds = kMostRounds, .steps = 2, .enough = 0.3, .round_enough = 1.0};
constexpr likelihood::FitOptions kRound{.noise_rounds = 1, .steps = 2, .enough = 0.3};
constexpr double kStillOpen = 0.5;  // of the best one's gain
// Rounds gain less and less: all that come after one have brought about as much as it did.
constexpr double kToCome = 2.0;    // times the last round's gain, at most
constexpr double kOverdue = 0.25;  // for progress: of its rounds, what a fit that takes more than others still takes

std::vector<std::string> names_of(const std::vector<model::ActiveEffect>& effects) {
  std::vector<std::string> names;
  names.reserve(effects.size());
  for (const model::ActiveEffect& active : effects) names.emplace_back(active.effect->name());
  std::ranges::sort(names);
  return names;
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

double log_prior_of_set(const std::vector<model::ActiveEffect>& effects, const std::vector<Law>& laws) {
  std::map<std::string, int> forms;
  std::size_t names = 0;  // that a craft may lack
  for (const Law& law : laws) {
    if (forms.emplace(law.name, law.forms).second && !by_nature(law.seed)) ++names;
  }
  const std::size_t n = claims(effects), own = effects.size() - n;
  double log_prior = std::log(kCountPrior[std::min(n, kCountPrior.size() - 1)]);
  // One of (names over n) sets.
  for (std::size_t k = 0; k < n; ++k)
    log_prior -=
        std::log(std::max(1.0, static_cast<double>(names) - static_cast<double>(k)) / static_cast<double>(k + 1));
  log_prior += static_cast<double>(own) * std::log(kOwnFlowPrior);
  for (const model::ActiveEffect& active : effects) {
    const auto found = forms.find(std::string(active.effect->name()));
    log_prior -= std::log(static_cast<double>(found != forms.end() ? found->second : 1));
  }
  return log_prior;
}

Fitted FittedModels::judged(likelihood::Fit fit) const {
  Fitted fitted{.fit = std::move(fit)};
  fitted.names = names_of(fitted.fit.hypothesis.model.effects);
  fitted.score = fitted.fit.log_evidence + log_prior_of_set(fitted.fit.hypothesis.model.effects, laws_);
  if (!fitted.fit.finite) fitted.score = kNever;
  return fitted;
}

Fitted FittedModels::add(likelihood::Fit fit) {
  fitted_.push_back(judged(std::move(fit)));
  return fitted_.back();
}

void FittedModels::tell(double starts, double rounds) {
  to_come_ = starts;
  progress_.expect(kCandidateFit.phase, starts * rounds_ / ended_ + rounds, kCandidateFit.weight);
}

void FittedModels::begin(std::size_t starts) {
  const auto count = static_cast<double>(starts);
  tell(std::max(0.0, to_come_ - count), count * rounds_after(0.0));
  progress_.begin(kCandidateFit.phase, kCandidateFit.what);
}

double FittedModels::rounds_after(double rounds) const {
  return std::max(rounds_ / ended_ - rounds, kOverdue * rounds);
}

void FittedModels::ended(double fits, double rounds) {
  ended_ += fits;
  rounds_ += rounds;
  tell(to_come_, 0.0);
}

namespace {

/// Whether two fits of the same forms have come to the same numbers, within their deviations: then one is enough.
bool at_the_same_place(const Fitted& a, const Fitted& b) {
  const auto& effects = a.fit.hypothesis.model.effects;
  const bool alike = std::ranges::equal(
      effects, b.fit.hypothesis.model.effects,
      [](const auto& one, const auto& other) { return one.effect == other.effect && one.variant == other.variant; });
  if (!alike || a.fit.numbers.size() != b.fit.numbers.size()) return false;
  const Eigen::VectorXd sigma = a.fit.sigma();
  for (std::size_t j = 0; j < a.fit.numbers.size(); ++j) {
    if (a.fit.numbers[j].kind != likelihood::NumberKind::kEffect) continue;
    const double off = value(a.fit.hypothesis, a.fit.numbers[j]) - value(b.fit.hypothesis, a.fit.numbers[j]);
    if (std::abs(off) > sigma[static_cast<Eigen::Index>(j)]) return false;
  }
  return true;
}

}  // namespace

std::vector<Fitted> FittedModels::race(const std::vector<Start>& starts, Odds of) {
  if (starts.empty()) return {};
  begin(starts.size());
  std::vector<std::optional<likelihood::Fitting>> fits(starts.size());
  std::vector<Fitted> all(starts.size());
  std::vector<double> gained(starts.size(), 0.0);
  double rounds = 0.0;
  const auto go_on = [&](const std::vector<std::size_t>& those) {
    // Fits side by side, or one whose runs are.
    likelihood::FitOptions options = kRound;
    if (those.size() < static_cast<std::size_t>(threads_)) options.threads = threads_;
    for_each_index(those.size(), threads_, [&](std::size_t k) {
      const std::size_t i = those[k];
      if (!fits[i]) fits[i].emplace(problem_, starts[i].hypothesis, starts[i].noise, options);
      fits[i]->use_threads(options.threads);
      gained[i] = fits[i]->round();
      all[i] = judged(fits[i]->fit());
    });
    progress_.done(kCandidateFit.phase, static_cast<double>(those.size()));
    rounds += static_cast<double>(those.size());
  };
  std::vector<std::size_t> open(starts.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  go_on(open);
  const auto best = [&] { return std::max(of.to_beat, std::ranges::max_element(all, {}, &Fitted::score)->score); };
  std::erase_if(open, [&](std::size_t i) {
    const bool far = all[i].score < best() - of.near && all[i].score < of.from + kStillOpen * (best() - of.from);
    // What promised most goes on whatever its first step: a number that is none of the linear ones needs several.
    return !all[i].fit.finite || (far && i != 0);
  });
  for (int round = 1; round < kMostRounds && !open.empty(); ++round) {
    std::ranges::sort(open, std::greater{}, [&](std::size_t i) { return all[i].score; });
    std::vector<std::size_t> apart;
    for (const std::size_t i : open) {
      if (std::ranges::none_of(apart, [&](std::size_t other) { return at_the_same_place(all[other], all[i]); }))
        apart.push_back(i);
    }
    open = std::move(apart);
    tell(to_come_, static_cast<double>(open.size()) * rounds_after(round));
    go_on(open);
    std::erase_if(open, [&](std::size_t i) {
      return !all[i].fit.finite || gained[i] < kThorough.round_enough ||
             all[i].score + kToCome * gained[i] < best() - of.near;
    });
  }
  // What the last step of the noise has left open, where it tells.
  std::vector<std::size_t> told;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].fit.finite && all[i].score >= best() - of.near) told.push_back(i);
  }
  for_each_index(told.size(), threads_, [&](std::size_t k) {
    fits[told[k]]->use_threads(told.size() < static_cast<std::size_t>(threads_) ? threads_ : 1);
    fits[told[k]]->settle();
    all[told[k]] = judged(fits[told[k]]->fit());
  });
  fitted_.insert(fitted_.end(), all.begin(), all.end());
  ended(static_cast<double>(starts.size()), rounds);
  return all;
}

std::vector<Fitted> FittedModels::fit_all(const std::vector<Start>& starts) {
  if (starts.empty()) return {};
  begin(starts.size());
  std::vector<Fitted> all(starts.size());
  std::vector<double> rounds(starts.size(), 0.0);
  const bool alone = starts.size() == 1;
  likelihood::FitOptions options = kThorough;
  if (starts.size() < static_cast<std::size_t>(threads_)) options.threads = threads_;
  for_each_index(starts.size(), threads_, [&](std::size_t i) {
    likelihood::Fitting fitting{problem_, starts[i].hypothesis, starts[i].noise, options};
    fitting.run([&] {
      rounds[i] += 1.0;
      if (!alone) return;  // listeners hear one thread
      progress_.done(kCandidateFit.phase);
      tell(to_come_, rounds_after(rounds[i]));
    });
    all[i] = judged(fitting.fit());
  });
  fitted_.insert(fitted_.end(), all.begin(), all.end());
  const double sum = std::accumulate(rounds.begin(), rounds.end(), 0.0);
  if (!alone) progress_.done(kCandidateFit.phase, sum);
  ended(static_cast<double>(starts.size()), sum);
  return all;
}

Standing FittedModels::standing(const Fitted& best, double base, const std::string& name,
                                const std::set<std::vector<std::string>>& small) const {
  std::map<std::vector<std::string>, double> of_set;  // the best of each set of names
  for (const Fitted& fitted : fitted_) {
    // What scores more than the best was refused. For numbers on a limit: it is no model to compare with. For its size:
    // what is too small to matter and explains the same is a rival all the same.
    const double score = fitted.score > best.score && !small.contains(fitted.names) ? kNever : fitted.score;
    const auto [place, fresh] = of_set.try_emplace(fitted.names, score);
    if (!fresh) place->second = std::max(place->second, score);
  }
  std::vector<std::string> others = best.names;
  others.erase(std::ranges::find(others, name));
  // Over the highest: a set that is too small to matter may score thousands of nats more than the best.
  double highest = best.score;
  for (const auto& [names, score] : of_set) highest = std::max(highest, score);
  double sum = 0.0, with = 0.0, rest = kNever, of_rival = kNever;
  Standing standing;
  for (const auto& [names, score] : of_set) {
    const double weight = std::exp(score - highest);
    sum += weight;
    if (holds(names, name)) with += weight;
    if (names == others) rest = score;
    if (holds(names, name) || names.size() != best.names.size() || score <= of_rival) continue;
    of_rival = score;
    for (const std::string& other : names) {
      if (!holds(best.names, other)) standing.rival = other;
    }
  }
  if (sum > 0.0) standing.probability = with / sum;
  standing.odds = best.score - (rest > kNever ? rest : base);
  return standing;
}

const Fitted* FittedModels::best_of(const std::vector<std::string>& names) const {
  const Fitted* best = nullptr;
  for (const Fitted& fitted : fitted_) {
    if (fitted.fit.finite && fitted.names == names && (best == nullptr || fitted.score > best->score)) best = &fitted;
  }
  return best;
}

std::vector<Fitted> FittedModels::near(const Fitted& best, double within, std::size_t most) const {
  std::map<std::vector<std::string>, const Fitted*> of_set;
  for (const Fitted& fitted : fitted_) {
    if (!fitted.fit.finite || fitted.names == best.names || fitted.score < best.score - within) continue;
    const auto [place, fresh] = of_set.try_emplace(fitted.names, &fitted);
    if (!fresh && fitted.score > place->second->score) place->second = &fitted;
  }
  std::vector<Fitted> sets;
  sets.reserve(of_set.size());
  for (const auto& [names, fitted] : of_set) sets.push_back(*fitted);
  std::ranges::sort(sets, std::greater{}, &Fitted::score);
  sets.resize(std::min(sets.size(), most));
  return sets;
}

const Fitted* FittedModels::best_with(const std::string& name) const {
  const Fitted* best = nullptr;
  for (const Fitted& fitted : fitted_) {
    if (holds(fitted.names, name) && (best == nullptr || fitted.score > best->score)) best = &fitted;
  }
  return best;
}

}  // namespace fathom::inference
