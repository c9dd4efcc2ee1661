#include "common/inference/search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "common/base/parallel.hpp"

namespace fathom::inference {
namespace {

constexpr std::size_t kOtherForms = 4;     // of one effect, tried in its place
constexpr double kLouder = 5.0;            // by which the second scan's random force is smaller
constexpr std::array kLeaning{1.0, 10.0};  // times the noise's prior mean, where the base model's fits begin
// Of the best promise: what promises less has never been the true one. Promises are linear, so that a law's own is
// wrong by a factor of two where its numbers are far from its grid.
constexpr double kFarBehind = 0.2;

struct Proposal {
  std::vector<model::ActiveEffect> added;
  likelihood::Noise noise;  ///< from which its fit begins
  bool first{};             ///< asked before the others
};

class Search {
 public:
  Search(const likelihood::Problem& problem, const model::Scene& scene, const std::vector<std::string>& without,
         const Thresholds& thresholds, int threads, const Progress& progress, const Deadline& deadline)
      : problem_{problem},
        scene_{scene},
        laws_{catalogue(scene, without)},
        thresholds_{thresholds},
        threads_{threads},
        progress_{progress},
        deadline_{deadline},
        models_{problem, laws_, threads, progress} {}

  Found run() {
    expect(kBaseFit, 1);
    expect_rounds(2);
    expect(kFreeForceFit, 1);
    begin(kBaseFit);
    found_.base = models_.add(fit_base());
    progress_.done(kBaseFit.phase);
    found_.best = found_.base;
    if (!found_.base.fit.finite) return std::move(found_);
    const auto room = [&] { return thresholds_.most_effects - static_cast<int>(effects().size()); };
    while (room() > 0 && goes_on()) {
      expect_rounds(std::min(2, room()));  // this one, and one that finds nothing
      if (!add_some()) break;
      drop();
    }
    expect_rounds(0);
    leave_out();
    judge_effects();
    // What gives way to something unlisted need not be told from other names.
    progress_.expect(kFreeForceFit.phase, 1 + static_cast<double>(effects().size()), kFreeForceFit.weight);
    found_.free_force = free_force_beside(found_.best);
    give_way();
    progress_.expect(kFreeForceFit.phase, 0);
    if (swap()) found_.free_force = free_force_beside(found_.best);
    judge_effects();
    expect_rounds(0);
    list_refused();
    found_.fits = models_.size();
    return std::move(found_);
  }

 private:
  /// The better of two after a round of each: begun from the noise's prior means, and with random forces as large as
  /// the motion's own. There the filter leans on the measurements: whatever the numbers it begins from, it does not run
  /// away, and the first steps are a fit of accelerations.
  [[nodiscard]] likelihood::Fit fit_base() const {
    std::array<likelihood::Fit, kLeaning.size()> fits;
    likelihood::FitOptions options{.noise_rounds = 1, .steps = 3, .enough = 0.2, .choose_tail = true};
    for_each_index(fits.size(), threads_, [&](std::size_t i) {
      likelihood::Noise noise = likelihood::prior_noise(problem_);
      for (likelihood::AxisNoise& axis : noise) {
        axis.log[likelihood::kForce] += std::log(kLeaning[i]);
        axis.log[likelihood::kWhiteForce] += std::log(kLeaning[i]);
      }
      fits[i] = likelihood::fit(problem_, likelihood::nominal_hypothesis(problem_), noise, options);
    });
    const bool leaning = !fits[0].finite || (fits[1].finite && fits[1].log_evidence > fits[0].log_evidence);
    const likelihood::Fit& ahead = fits[leaning ? 1 : 0];
    if (!ahead.finite) return ahead;
    options.noise_rounds = 20;  // at most: it ends when a round gains nothing
    options.threads = threads_;
    likelihood::Fit on = likelihood::fit(problem_, ahead.hypothesis, ahead.noise, options);
    return on.finite ? on : ahead;
  }
  void expect(const Step& step, double units) const { progress_.expect(step.phase, units, step.weight); }
  void begin(const Step& step) const { progress_.begin(step.phase, step.what); }
  /// Scans and fits of so many rounds, this one included.
  void expect_rounds(double rounds) {
    models_.expect(rounds * (thresholds_.fits_per_round + thresholds_.pairs_per_round));
    expect(kScan, rounds);
  }
  /// There is time for more.
  bool goes_on() {
    if (!found_.cut_short && deadline_.over()) {
      found_.cut_short = true;
      found_.spent = deadline_.elapsed();
      found_.given = deadline_.seconds();
    }
    return !found_.cut_short;
  }
  [[nodiscard]] const std::vector<model::ActiveEffect>& effects() const {
    return found_.best.fit.hypothesis.model.effects;
  }
  [[nodiscard]] model::ActiveEffect effect_of(std::size_t law, const std::vector<double>& theta) const {
    model::ActiveEffect active = laws_[law].seed;
    active.theta = theta;
    return active;
  }

  /// What promises most beside a model: the best laws and pairs, seen at its noise and, where a random force may have
  /// swallowed something slow, at a fifth of it. `least`: what a promise must come to, in nats.
  std::vector<Proposal> proposals(const Fitted& from, double least, bool with_pairs) {
    std::vector<Proposal> proposals;
    promised_.clear();
    const auto take = [&](const Scan& scan, const likelihood::Noise& noise) {
      const double best = scan.promises.empty() ? 0.0 : scan.promises.front().score;
      int singles = 0;
      std::map<std::string, int> of_name;
      for (const Promise& promise : scan.promises) {
        note(promise);
        const bool first = asked_first(laws_[promise.law]);
        if (promise.score < least || (!first && promise.score < kFarBehind * best)) continue;
        if (of_name[laws_[promise.law].name]++ > 0) continue;  // the best form of each
        if (!first && singles++ >= thresholds_.fits_per_round) continue;
        proposals.push_back({{effect_of(promise.law, promise.theta)}, noise, first});
      }
      int pairs = 0;
      for (const PairPromise& pair : scan.pairs) {
        if (!with_pairs || pairs >= thresholds_.pairs_per_round || pair.score < best + thresholds_.pair_gain) break;
        proposals.push_back({{effect_of(scan.promises[pair.first].law, pair.theta_first),
                              effect_of(scan.promises[pair.second].law, pair.theta_second)},
                             noise});
        ++pairs;
      }
    };
    begin(kScan);
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
    progress_.done(kScan.phase);
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

  static std::vector<Start> starts(const likelihood::Hypothesis& from, const std::vector<Proposal>& proposals) {
    std::vector<Start> starts;
    for (const Proposal& proposal : proposals) {
      starts.push_back({from, proposal.noise});
      for (const model::ActiveEffect& active : proposal.added) starts.back().hypothesis.model.add(active);
    }
    return starts;
  }
  [[nodiscard]] static Start without(const Fitted& from, std::size_t effect) {
    Start start{from.fit.hypothesis, from.fit.noise};
    auto& effects = start.hypothesis.model.effects;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(effect));
    return start;
  }

  /// Takes the best of these where it is a name's worth better; else false.
  bool take_best(std::vector<Fitted> fits) {
    std::ranges::sort(fits, std::greater{}, &Fitted::score);
    for (Fitted& fitted : fits) {
      if (!fitted.fit.finite || fitted.score < found_.best.score + thresholds_.name_odds) return false;
      if (!counts(fitted)) continue;
      const std::vector<model::ActiveEffect> before = effects();
      found_.best = std::move(fitted);
      simplify(before);
      return true;
    }
    return false;
  }

  bool add_some() {
    const bool pairs = found_.best.names.size() + 2 <= static_cast<std::size_t>(thresholds_.most_effects);
    std::vector<Proposal> all = proposals(found_.best, thresholds_.score_worth, pairs), first;
    std::ranges::copy_if(all, std::back_inserter(first), &Proposal::first);
    std::erase_if(all, [](const Proposal& proposal) { return proposal.first; });
    const likelihood::Hypothesis from = found_.best.fit.hypothesis;
    if (take_best(models_.race(starts(from, first), found_.best.score))) return true;
    return take_best(models_.race(starts(from, all), found_.best.score));
  }

  static bool held(const std::vector<model::ActiveEffect>& effects, const model::ActiveEffect& active) {
    return std::ranges::any_of(
        effects, [&](const auto& other) { return other.effect == active.effect && other.variant == active.variant; });
  }

  /// Every effect that the best model does not hold yet has the smallest practical size and numbers of its own; else
  /// it is noted why not.
  [[nodiscard]] bool counts(const Fitted& fitted) {
    const Seen seen = see(problem_, fitted.fit, threads_);
    const auto& those = seen.fit.hypothesis.model.effects;
    for (std::size_t e = 0; e < those.size(); ++e) {
      if (held(effects(), those[e])) continue;
      const double size = size_of_effect(problem_, seen, e);
      const bool at_limit = stopped(those[e], *problem_.vehicle);
      if (!at_limit && size >= thresholds_.smallest_size) continue;
      failed_[std::string(those[e].effect->name())] =
          at_limit ? Refusal{Rule::kBound, fitted.score - found_.best.score, thresholds_.name_odds}
                   : Refusal{Rule::kSize, size, thresholds_.smallest_size};
      return false;
    }
    return true;
  }

  /// Other forms of the effects that were just found, begun from their shared numbers, where the score promised at
  /// least half as much: the best stays.
  void simplify(const std::vector<model::ActiveEffect>& before) {
    const std::vector<model::ActiveEffect> now = effects();
    for (const model::ActiveEffect& active : now) {
      if (held(before, active) || forms_matter(active)) continue;
      double promised = 0.0;
      for (std::size_t l = 0; l < laws_.size(); ++l) {
        if (laws_[l].seed.effect == active.effect && promised_.contains(l)) promised = std::max(promised, promised_[l]);
      }
      std::vector<Proposal> others;
      for (std::size_t l = 0; l < laws_.size() && others.size() < kOtherForms; ++l) {
        const Law& law = laws_[l];
        if (law.seed.effect != active.effect || law.seed.variant == active.variant) continue;
        if (!promised_.contains(l) || promised_[l] < 0.5 * promised) continue;
        others.push_back({{law.seed}, found_.best.fit.noise});
        std::vector<double>& theta = others.back().added.front().theta;
        for (std::size_t c = 0; c < active.theta.size(); ++c) {
          if (moves(law.seed, c) && moves(active, c)) theta[c] = active.theta[c];
          if (!moves(law.seed, c)) theta[c] = 0.0;
        }
      }
      likelihood::Hypothesis rest = found_.best.fit.hypothesis;
      std::erase_if(rest.model.effects, [&](const auto& other) {
        return other.effect == active.effect && other.variant == active.variant;
      });
      for (const Fitted& other : models_.race(starts(rest, others), found_.base.score, found_.best.score)) {
        if (other.fit.finite && other.score > found_.best.score && counts(other)) found_.best = other;
      }
    }
  }

  /// Nats that the best model would lose without the effect, by Wald's test of its leading numbers: a linear guess.
  [[nodiscard]] double guessed_loss(const Seen& seen, std::size_t effect) const {
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
    return 0.5 * theta.dot(covariance.ldlt().solve(theta));
  }

  /// What another effect has made small or worthless, or pushed to a limit, goes.
  void drop() {
    while (effects().size() > 1) {
      const Seen seen = see(problem_, found_.best.fit, threads_);
      std::vector<Start> small, weak;
      for (std::size_t e = 0; e < effects().size(); ++e) {
        if (stopped(effects()[e], *problem_.vehicle) || size_of_effect(problem_, seen, e) < thresholds_.smallest_size) {
          small.push_back(without(found_.best, e));
        } else if (guessed_loss(seen, e) < kDoubtful * thresholds_.name_odds) {
          weak.push_back(without(found_.best, e));
        }
      }
      const std::vector<Fitted> fits = models_.fit_all(small.empty() ? weak : small);
      const auto best = std::ranges::max_element(fits, {}, &Fitted::score);
      if (best == fits.end() || !best->fit.finite) return;
      // What stands by less than a name needs is no name.
      if (small.empty() && best->score + thresholds_.name_odds <= found_.best.score) return;
      found_.best = *best;
    }
  }

  [[nodiscard]] std::vector<std::string> names_without(std::size_t effect) const {
    std::vector<std::string> others = found_.best.names;
    others.erase(std::ranges::find(others, effects()[effect].effect->name()));
    return others;
  }

  /// The best model without each effect, where none has been fitted yet.
  void leave_out() {
    std::vector<Start> starts;
    for (std::size_t e = 0; e < effects().size(); ++e) {
      if (models_.best_of(names_without(e)) == nullptr) starts.push_back(without(found_.best, e));
    }
    if (!starts.empty() && goes_on()) models_.fit_all(starts);
  }

  /// For each of several effects: leave it out, scan, fit in its place what promises about as much. Whether any was
  /// exchanged.
  bool swap() {
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
      for (const Fitted& other : models_.race(starts(rest.fit.hypothesis, proposed), rest.score, found_.best.score)) {
        if (!other.fit.finite || other.score <= found_.best.score || !counts(other)) continue;
        found_.best = other;
        exchanged = true;
        in_place_.clear();
      }
      if (exchanged) leave_out();
    }
    return exchanged;
  }

  /// `relatives`: in whose place it stands.
  [[nodiscard]] FreeForceFound free_force_beside(const Fitted& fitted,
                                                 std::span<const model::ActiveEffect> relatives = {}) const {
    begin(kFreeForceFit);
    FreeForceFound found = find_free_force(problem_, see(problem_, fitted.fit, threads_), scene_, thresholds_, threads_,
                                           deadline_, relatives);
    progress_.done(kFreeForceFit.phase);
    return found;
  }

  static double worth(const FreeForceFound& force) { return std::max(0.0, force.log_odds); }

  /// "Something that no list holds" may act in a name's place as well as beside it: both with the free force that is
  /// best there. Names that are not worth their odds over that are none, and the free force stays in their place. First
  /// all together that are worth less than the free force beside them, then each once, the weakest first.
  void give_way() {
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
      const auto place = std::ranges::find_if(effects(), [&](const auto& other) {
        return other.effect == active.effect && other.variant == active.variant;
      });
      if (place == effects().end()) continue;
      if (!goes_on()) return;
      const auto e = static_cast<std::size_t>(place - effects().begin());
      const Fitted* rest = models_.best_of(names_without(e));
      if (rest != nullptr) takes_the_place({e}, Fitted{*rest});
    }
  }

  /// If the free force beside `rest`, which lacks these effects, does what they do, they are gone.
  void takes_the_place(const std::vector<std::size_t>& gone, const Fitted& rest) {
    std::vector<model::ActiveEffect> relatives;
    for (const std::size_t e : gone) relatives.push_back(effects()[e]);
    FreeForceFound force = free_force_beside(rest, relatives);
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

  void judge_effects() {
    found_.odds.clear();
    found_.size.clear();
    found_.probability.clear();
    found_.rival.clear();
    if (effects().empty()) return;
    const Seen seen = see(problem_, found_.best.fit, threads_);
    for (std::size_t e = 0; e < effects().size(); ++e) {
      found_.size.push_back(size_of_effect(problem_, seen, e));
      const Standing standing =
          models_.standing(found_.best, found_.base.score, std::string(effects()[e].effect->name()));
      found_.probability.push_back(standing.probability);
      const auto in_place = in_place_.find(std::string(effects()[e].effect->name()));
      found_.odds.push_back(in_place != in_place_.end() ? std::min(standing.odds, in_place->second) : standing.odds);
      found_.rival.push_back(standing.rival);
    }
  }

  void note(const Promise& promise) {
    auto [place, fresh] = noted_.try_emplace(laws_[promise.law].name, promise);
    if (!fresh && promise.score > place->second.score) place->second = promise;
    auto [of_form, new_form] = promised_.try_emplace(promise.law, promise.score);
    if (!new_form) of_form->second = std::max(of_form->second, promise.score);
  }

  /// By its best fit: beside all that was found it lacks odds, size or numbers of its own; in place of something that
  /// was found it is less probable.
  [[nodiscard]] Refusal refusal(const std::string& name, double promised) const {
    const Fitted* best = models_.best_with(name);
    if (best == nullptr) return {Rule::kScore, promised, thresholds_.score_worth};
    const double odds = best->score - found_.best.score;
    if (const auto gave_way = gave_way_.find(name); gave_way != gave_way_.end()) return gave_way->second;
    if (!std::ranges::includes(best->names, found_.best.names))
      return {Rule::kProbability, 1.0 / (1.0 + std::exp(-odds)), thresholds_.name_probability};
    if (odds < thresholds_.name_odds) return {Rule::kOdds, odds, thresholds_.name_odds};
    const auto failed = failed_.find(name);
    return failed != failed_.end() ? failed->second : Refusal{Rule::kOdds, odds, thresholds_.name_odds};
  }

  void list_refused() {
    for (const auto& [name, promise] : noted_) {
      if (std::ranges::find(found_.best.names, name) != found_.best.names.end()) continue;
      Refused refused{.name = name, .form = laws_[promise.law].form, .promised = promise.score};
      refused.refusals.push_back(refusal(name, promise.score));
      found_.refused.push_back(std::move(refused));
    }
    std::ranges::sort(found_.refused, std::greater{}, &Refused::promised);
  }

  static constexpr double kDoubtful = 5.0;  // times a name's odds: a guess of less is asked of a fit

  const likelihood::Problem& problem_;
  const model::Scene& scene_;
  std::vector<Law> laws_;
  const Thresholds& thresholds_;
  int threads_;
  const Progress& progress_;
  const Deadline& deadline_;
  FittedModels models_;
  Found found_;
  std::map<std::string, Promise> noted_;
  std::map<std::size_t, double> promised_;   // by law, in the last look
  std::map<std::string, Refusal> failed_;    // what evidence alone would have named
  std::map<std::string, Refusal> gave_way_;  // to a free force in its place
  std::map<std::string, double> in_place_;   // nats by which a name is worth more than that
};

}  // namespace

Found search(const likelihood::Problem& problem, const model::Scene& scene, const std::vector<std::string>& without,
             const Thresholds& thresholds, int threads, const Progress& progress, const Deadline& deadline) {
  return Search{problem, scene, without, thresholds, threads, progress, deadline}.run();
}

}  // namespace fathom::inference
