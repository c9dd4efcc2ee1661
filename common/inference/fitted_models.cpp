#include "common/inference/fitted_models.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/parallel.hpp"

namespace fathom::inference {
namespace {

constexpr std::array kCountPrior{0.5, 0.3, 0.13, 0.05, 0.02};  // of 0 to 4 effects
constexpr double kNever = -1e300;                              // score of what could not be fitted

// One step of the numbers and one of the noise tell a candidate's rank; only what may still win goes on. What has not
// gained half of what the best has, and is not near it, has never won afterwards.
constexpr likelihood::FitOptions kGlance{.noise_rounds = 1, .steps = 1, .enough = 0.5};
// A fit ends when a round gains no nat any more, not after so many: where numbers and noise move each other slowly
// (drag of third order beside a random force: a hundred nats a round), a fit that is cut short is beaten by anything.
constexpr int kMostRounds = 20;
constexpr likelihood::FitOptions kThorough{.noise_rounds = kMostRounds, .steps = 2, .enough = 0.3, .round_enough = 1.0};
constexpr likelihood::FitOptions kRound{.noise_rounds = 1, .steps = 2, .enough = 0.3};
constexpr double kStillOpen = 0.5;  // of the best one's gain
constexpr double kNear = 30.0;      // nats
// Rounds gain less and less: all that come after one have brought about as much as it did.
constexpr double kToCome = 2.0;  // times the last round's gain, at most

std::vector<std::string> names_of(const std::vector<model::ActiveEffect>& effects) {
  std::vector<std::string> names;
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
  for (const Law& law : laws) forms[law.name] = law.forms;
  const std::size_t n = effects.size();
  double log_prior = std::log(kCountPrior[std::min(n, kCountPrior.size() - 1)]);
  // One of (names over n) sets.
  for (std::size_t k = 0; k < n; ++k)
    log_prior -= std::log(std::max(1.0, static_cast<double>(forms.size() - std::min(k, forms.size() - 1))) /
                          static_cast<double>(k + 1));
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

void FittedModels::expect(double starts) {
  to_come_ = starts;
  progress_.expect(kCandidateFit.phase, to_come_, kCandidateFit.weight);
}

std::vector<Fitted> FittedModels::fits(const std::vector<Start>& starts, const likelihood::FitOptions& options) {
  std::vector<Fitted> fits(starts.size());
  likelihood::FitOptions one_thread = options;
  // Few fits side by side, or one whose runs are.
  if (starts.size() < static_cast<std::size_t>(threads_)) one_thread.threads = threads_;
  for_each_index(starts.size(), threads_, [&](std::size_t i) {
    fits[i] = judged(likelihood::fit(problem_, starts[i].hypothesis, starts[i].noise, one_thread));
  });
  return fits;
}

std::vector<Fitted> FittedModels::race(const std::vector<Start>& starts, double from, double to_beat) {
  if (starts.empty()) return {};
  const auto count = static_cast<double>(starts.size());
  expect(std::max(to_come_, count));
  progress_.begin(kCandidateFit.phase, kCandidateFit.what);
  std::vector<Fitted> all = fits(starts, kGlance);
  const auto best = [&] { return std::max(to_beat, std::ranges::max_element(all, {}, &Fitted::score)->score); };
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool far = all[i].score < best() - kNear && all[i].score < from + kStillOpen * (best() - from);
    // What promised most goes on whatever its first step: a number that is none of the linear ones needs several.
    if (all[i].fit.finite && (!far || i == 0)) open.push_back(i);
  }
  for (int round = 0; round < kMostRounds && !open.empty(); ++round) {
    std::vector<Start> on;
    for (const std::size_t i : open) on.push_back({all[i].fit.hypothesis, all[i].fit.noise});
    const std::vector<Fitted> further = fits(on, kRound);
    std::vector<double> gained(open.size(), 0.0);
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (!further[k].fit.finite) continue;
      gained[k] = further[k].score - all[open[k]].score;
      all[open[k]] = further[k];
    }
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (gained[k] >= kThorough.round_enough && all[open[k]].score + kToCome * gained[k] >= best() - kNear)
        still.push_back(open[k]);
    }
    open = std::move(still);
  }
  fitted_.insert(fitted_.end(), all.begin(), all.end());
  progress_.done(kCandidateFit.phase, count);
  to_come_ = std::max(0.0, to_come_ - count);
  return all;
}

std::vector<Fitted> FittedModels::fit_all(const std::vector<Start>& starts) {
  const auto count = static_cast<double>(starts.size());
  expect(std::max(to_come_, count));
  progress_.begin(kCandidateFit.phase, kCandidateFit.what);
  std::vector<Fitted> all = fits(starts, kThorough);
  fitted_.insert(fitted_.end(), all.begin(), all.end());
  progress_.done(kCandidateFit.phase, count);
  to_come_ = std::max(0.0, to_come_ - count);
  return all;
}

Standing FittedModels::standing(const Fitted& best, double base, const std::string& name) const {
  std::map<std::vector<std::string>, double> of_set;  // the best of each set of names
  for (const Fitted& fitted : fitted_) {
    // What scores more than the best was refused for its size or for numbers on a limit: it is no model to compare
    // with.
    const double score = fitted.score > best.score ? kNever : fitted.score;
    const auto [place, fresh] = of_set.try_emplace(fitted.names, score);
    if (!fresh) place->second = std::max(place->second, score);
  }
  std::vector<std::string> others = best.names;
  others.erase(std::ranges::find(others, name));
  double sum = 0.0, with = 0.0, rest = kNever, of_rival = kNever;
  Standing standing;
  for (const auto& [names, score] : of_set) {
    const double weight = std::exp(score - best.score);
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

const Fitted* FittedModels::best_with(const std::string& name) const {
  const Fitted* best = nullptr;
  for (const Fitted& fitted : fitted_) {
    if (holds(fitted.names, name) && (best == nullptr || fitted.score > best->score)) best = &fitted;
  }
  return best;
}

}  // namespace fathom::inference
