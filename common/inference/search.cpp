#include "common/inference/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/base/parallel.hpp"

namespace fathom::inference {
namespace {

constexpr std::array kCountPrior{0.5, 0.3, 0.13, 0.05, 0.02};  // of 0 to 4 effects
constexpr std::size_t kOtherForms = 4;                         // of one effect, tried in its place
constexpr double kLouder = 5.0;                                // by which the second scan's random force is smaller

std::vector<std::string> names_of(const std::vector<model::ActiveEffect>& effects) {
  std::vector<std::string> names;
  for (const model::ActiveEffect& active : effects) names.emplace_back(active.effect->name());
  std::ranges::sort(names);
  return names;
}

struct Proposal {
  std::vector<model::ActiveEffect> added;
  double promised{};
  likelihood::Noise noise;  ///< from which its fit begins
};

class Search {
 public:
  Search(const likelihood::Problem& problem, const model::Scene& scene, const std::vector<std::string>& without,
         const Thresholds& thresholds, int threads, const Progress& progress)
      : problem_{problem},
        scene_{scene},
        laws_{catalogue(scene, without)},
        thresholds_{thresholds},
        threads_{threads},
        progress_{progress} {}

  Found run() {
    progress_("fitting the base model", 0.02);
    found_.base =
        judged(likelihood::fit(problem_, likelihood::nominal_hypothesis(problem_), likelihood::prior_noise(problem_),
                               {.noise_rounds = 5, .choose_tail = true, .threads = threads_}));
    found_.best = found_.base;
    fitted_.push_back(found_.base);
    if (!found_.base.fit.finite) return std::move(found_);
    for (int round = 0; round < thresholds_.most_effects; ++round) {
      progress_("asking every effect", 0.1 + 0.15 * round);
      if (!add_one()) break;
      progress_("taking effects out again", 0.2 + 0.15 * round);
      simplify();
      drop();
    }
    if (found_.best.fit.hypothesis.model.effects.size() > 1) {
      progress_("asking for others in place of each", 0.75);
      swap();
    }
    judge_effects();
    progress_("looking for a force that no list holds", 0.85);
    found_.free_force =
        find_free_force(problem_, see(problem_, found_.best.fit, threads_), scene_, thresholds_, threads_);
    list_refused();
    found_.fits = fitted_.size();
    return std::move(found_);
  }

 private:
  Fitted judged(likelihood::Fit fit) const {
    Fitted fitted{.fit = std::move(fit)};
    fitted.names = names_of(fitted.fit.hypothesis.model.effects);
    fitted.score = fitted.fit.log_evidence + log_prior_of_set(fitted.fit.hypothesis.model.effects, laws_);
    if (!fitted.fit.finite) fitted.score = -1e300;
    return fitted;
  }

  [[nodiscard]] model::ActiveEffect effect_of(std::size_t law, const std::vector<double>& theta) const {
    model::ActiveEffect active = laws_[law].seed;
    active.theta = theta;
    return active;
  }

  /// What promises most beside a model: the best laws and pairs, seen at its noise and, where a random force may have
  /// swallowed something slow, at a fifth of it.
  std::vector<Proposal> proposals(const Fitted& from) {
    std::vector<Proposal> proposals;
    const auto take = [&](const Scan& scan, const likelihood::Noise& noise) {
      int singles = 0;
      std::map<std::string, int> of_name;
      for (const Promise& promise : scan.promises) {
        note(promise);
        if (singles >= thresholds_.fits_per_round || promise.score < thresholds_.score_worth) continue;
        if (of_name[laws_[promise.law].name]++ > 0) continue;  // the best form of each
        proposals.push_back({{effect_of(promise.law, promise.theta)}, promise.score, noise});
        ++singles;
      }
      int pairs = 0;
      const double best = scan.promises.empty() ? 0.0 : scan.promises.front().score;
      for (const PairPromise& pair : scan.pairs) {
        if (pairs >= thresholds_.pairs_per_round || pair.score < best + thresholds_.pair_gain) break;
        if (from.names.size() + 2 > static_cast<std::size_t>(thresholds_.most_effects)) break;
        proposals.push_back({{effect_of(scan.promises[pair.first].law, pair.theta_first),
                              effect_of(scan.promises[pair.second].law, pair.theta_second)},
                             pair.score,
                             noise});
        ++pairs;
      }
    };
    const Seen seen = see(problem_, from.fit, threads_);
    take(scan(problem_, seen, laws_, thresholds_, threads_), from.fit.noise);
    bool large = false;
    likelihood::Fit louder = from.fit;
    for (int i = 0; i < problem_.simulated; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const double applied = seen.applied[problem_.axes[axis]];
      large = large || (from.fit.noise[axis][likelihood::kForce] > thresholds_.large_random * applied &&
                        from.fit.noise[axis][likelihood::kForceMemory] > thresholds_.swallowing_memory);
      louder.noise[axis].log[likelihood::kForce] -= std::log(kLouder);
    }
    if (large) {
      const Seen again = see(problem_, louder, threads_);
      take(scan(problem_, again, laws_, thresholds_, threads_), louder.noise);
    }
    // One fit of each set of forms.
    std::vector<Proposal> unlike;
    for (Proposal& proposal : proposals) {
      const bool same = std::ranges::any_of(unlike, [&](const Proposal& other) {
        return other.added.size() == proposal.added.size() &&
               std::ranges::equal(other.added, proposal.added, [](const auto& a, const auto& b) {
                 return a.effect == b.effect && a.variant == b.variant;
               });
      });
      if (!same) unlike.push_back(std::move(proposal));
    }
    return unlike;
  }

  std::vector<Fitted> fit_all(const Fitted& from, const std::vector<Proposal>& proposals) {
    std::vector<Fitted> fits(proposals.size());
    for_each_index(proposals.size(), threads_, [&](std::size_t i) {
      likelihood::Hypothesis hypothesis = from.fit.hypothesis;
      for (const model::ActiveEffect& active : proposals[i].added) hypothesis.model.add(active);
      fits[i] = judged(likelihood::fit(problem_, hypothesis, proposals[i].noise, {}));
    });
    fitted_.insert(fitted_.end(), fits.begin(), fits.end());
    return fits;
  }

  bool add_one() {
    const std::vector<Proposal> proposed = proposals(found_.best);
    const std::vector<Fitted> fits = fit_all(found_.best, proposed);
    const Fitted* best = nullptr;
    for (const Fitted& fitted : fits) {
      if (!fitted.fit.finite || fitted.score < found_.best.score + thresholds_.name_odds) continue;
      if (best != nullptr && fitted.score <= best->score) continue;
      if (!counts(fitted)) continue;
      best = &fitted;
    }
    if (best == nullptr) return false;
    found_.best = *best;
    return true;
  }

  [[nodiscard]] bool held(const model::ActiveEffect& active) const {
    return std::ranges::any_of(found_.best.fit.hypothesis.model.effects, [&](const auto& other) {
      return other.effect == active.effect && other.variant == active.variant;
    });
  }

  /// Every effect that the best model does not hold yet has the smallest practical size and numbers of its own.
  [[nodiscard]] bool counts(const Fitted& fitted) const {
    const Seen seen = see(problem_, fitted.fit, threads_);
    const auto& effects = seen.fit.hypothesis.model.effects;
    for (std::size_t e = 0; e < effects.size(); ++e) {
      if (held(effects[e])) continue;
      if (stopped(effects[e], *problem_.vehicle)) return false;
      if (size_of_effect(problem_, seen, e) < thresholds_.smallest_size) return false;
    }
    return true;
  }

  /// What another effect has made small, or pushed to a limit, goes.
  bool drop_small() {
    const Seen seen = see(problem_, found_.best.fit, threads_);
    const auto& effects = seen.fit.hypothesis.model.effects;
    for (std::size_t e = 0; e < effects.size() && effects.size() > 1; ++e) {
      if (!stopped(effects[e], *problem_.vehicle) && size_of_effect(problem_, seen, e) >= thresholds_.smallest_size)
        continue;
      std::vector<Fitted> fits(effects.size());
      Fitted rest = without(found_.best, e, fits);
      if (!rest.fit.finite) continue;
      fitted_.push_back(rest);
      found_.best = std::move(rest);
      return true;
    }
    return false;
  }

  Fitted without(const Fitted& from, std::size_t effect, std::vector<Fitted>& fits) const {
    likelihood::Hypothesis hypothesis = from.fit.hypothesis;
    hypothesis.model.effects.erase(hypothesis.model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
    fits[effect] = judged(likelihood::fit(problem_, hypothesis, from.fit.noise, {}));
    return fits[effect];
  }

  /// Other forms of the effects that were found, begun from their shared numbers: the simplest that does as well stays.
  void simplify() {
    const std::vector<model::ActiveEffect> effects = found_.best.fit.hypothesis.model.effects;
    for (const model::ActiveEffect& active : effects) {
      std::vector<Proposal> others;
      for (const Law& law : laws_) {
        if (law.seed.effect != active.effect || law.seed.variant == active.variant) continue;
        if (forms_matter(active) || others.size() >= kOtherForms) continue;
        others.push_back({{law.seed}, 0.0, found_.best.fit.noise});
        for (std::size_t c = 0; c < active.theta.size(); ++c) {
          if (moves(law.seed, c) && moves(active, c)) others.back().added.front().theta[c] = active.theta[c];
          if (!moves(law.seed, c)) others.back().added.front().theta[c] = 0.0;
        }
      }
      if (others.empty()) continue;
      Fitted rest = found_.best;
      std::erase_if(rest.fit.hypothesis.model.effects, [&](const auto& other) {
        return other.effect == active.effect && other.variant == active.variant;
      });
      for (const Fitted& other : fit_all(rest, others)) {
        if (other.fit.finite && other.score > found_.best.score && counts(other)) found_.best = other;
      }
    }
  }

  void drop() {
    while (drop_small()) {
    }
    while (found_.best.fit.hypothesis.model.effects.size() > 1) {
      std::vector<Fitted> fits(found_.best.fit.hypothesis.model.effects.size());
      for_each_index(fits.size(), threads_, [&](std::size_t e) { (void)without(found_.best, e, fits); });
      fitted_.insert(fitted_.end(), fits.begin(), fits.end());
      const auto best = std::ranges::max_element(fits, {}, &Fitted::score);
      // What stands by less than a name needs is no name.
      if (best->score + thresholds_.name_odds <= found_.best.score) return;
      found_.best = *best;
    }
  }

  /// For each effect: leave it out, scan, fit the best in its place.
  void swap() {
    for (std::size_t e = 0; e < found_.best.fit.hypothesis.model.effects.size(); ++e) {
      std::vector<Fitted> fits(found_.best.fit.hypothesis.model.effects.size());
      const Fitted rest = without(found_.best, e, fits);
      fitted_.push_back(rest);
      if (!rest.fit.finite) continue;
      std::vector<Proposal> proposed = proposals(rest);
      std::erase_if(proposed, [](const Proposal& proposal) { return proposal.added.size() > 1; });
      for (const Fitted& other : fit_all(rest, proposed)) {
        if (other.fit.finite && other.score > found_.best.score && counts(other)) found_.best = other;
      }
    }
  }

  void judge_effects() {
    const auto& effects = found_.best.fit.hypothesis.model.effects;
    if (effects.empty()) return;
    const Seen seen = see(problem_, found_.best.fit, threads_);
    double sum = 0.0;
    std::map<std::vector<std::string>, double> of_set;  // the best of each set of names
    for (const Fitted& fitted : fitted_) {
      const auto [place, fresh] = of_set.try_emplace(fitted.names, fitted.score);
      if (!fresh) place->second = std::max(place->second, fitted.score);
    }
    for (const auto& [names, score] : of_set) sum += std::exp(score - found_.best.score);
    for (std::size_t e = 0; e < effects.size(); ++e) {
      const std::string name{effects[e].effect->name()};
      found_.size.push_back(size_of_effect(problem_, seen, e));
      double with = 0.0, rest = -1e300, rival = -1e300;
      std::string rival_name;
      std::vector<std::string> others = found_.best.names;
      others.erase(std::ranges::find(others, name));
      for (const auto& [names, score] : of_set) {
        const bool holds = std::ranges::find(names, name) != names.end();
        if (holds) with += std::exp(score - found_.best.score);
        if (names == others) rest = score;
        if (holds || names.size() != found_.best.names.size() || score <= rival) continue;
        rival = score;
        for (const std::string& other : names) {
          if (std::ranges::find(found_.best.names, other) == found_.best.names.end()) rival_name = other;
        }
      }
      found_.probability.push_back(with / sum);
      found_.odds.push_back(rest > -1e299 ? found_.best.score - rest : found_.best.score - found_.base.score);
      found_.rival.push_back(rival_name);
    }
  }

  void note(const Promise& promise) {
    const Law& law = laws_[promise.law];
    auto [place, fresh] = noted_.try_emplace(law.name, promise);
    if (!fresh && promise.score > place->second.score) place->second = promise;
  }

  void list_refused() {
    for (const auto& [name, promise] : noted_) {
      if (std::ranges::find(found_.best.names, name) != found_.best.names.end()) continue;
      Refused refused{.name = name, .form = laws_[promise.law].form, .promised = promise.score};
      const Fitted* best = nullptr;
      for (const Fitted& fitted : fitted_) {
        if (std::ranges::find(fitted.names, name) == fitted.names.end()) continue;
        if (best == nullptr || fitted.score > best->score) best = &fitted;
      }
      if (best == nullptr) {
        refused.refusals.push_back({Rule::kScore, promise.score, thresholds_.score_worth});
      } else if (best->score < found_.base.score + thresholds_.name_odds) {
        refused.refusals.push_back({Rule::kOdds, best->score - found_.base.score, thresholds_.name_odds});
      } else {
        refused.refusals.push_back({Rule::kProbability, std::exp(std::min(0.0, best->score - found_.best.score)),
                                    thresholds_.name_probability});
      }
      found_.refused.push_back(std::move(refused));
    }
    std::ranges::sort(found_.refused, std::greater{}, &Refused::promised);
  }

  const likelihood::Problem& problem_;
  const model::Scene& scene_;
  std::vector<Law> laws_;
  const Thresholds& thresholds_;
  int threads_;
  const Progress& progress_;
  Found found_;
  std::vector<Fitted> fitted_;
  std::map<std::string, Promise> noted_;
};

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

Found search(const likelihood::Problem& problem, const model::Scene& scene, const std::vector<std::string>& without,
             const Thresholds& thresholds, int threads, const Progress& progress) {
  return Search{problem, scene, without, thresholds, threads, progress}.run();
}

}  // namespace fathom::inference
