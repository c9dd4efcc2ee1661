#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/inference/searching.hpp"
#include "common/inference/starts.hpp"
#include "common/likelihood/fitting.hpp"

namespace fathom::inference {
namespace {

constexpr double kLouder = 5.0;            // by which the second scan's random force is smaller
constexpr std::array kLeaning{1.0, 10.0};  // times the noise's prior mean, where the base model's fits begin
// Of the best promise, and then of what was really gained: what promises less has never been the true one. Promises are
// linear, so that a law's own is wrong by a factor of two where its numbers are far from its grid.
constexpr double kFarBehind = 0.2;
// Sets found on stretches that are asked of whole runs too: nats, and how many.
constexpr double kHardlyLess = 30.0;
constexpr std::size_t kMostNear = 4;
constexpr double kFitsOfWhole = 4.0;  // for progress, guessed: base model, what was found, what it is told from

}  // namespace

Found Searching::run(const Before* before) {
  if (before == nullptr) {
    expect(kBaseFit, kRoundsOfBase);
    expect_rounds(2);
    expect(kFreeForceFit, 1);
    begin(kBaseFit);
    found_.base = models_.add(fit_base());
    expect(kBaseFit, 0);
  } else {
    models_.expect(kFitsOfWhole);
    expect(kScan, 1);
    expect(kFreeForceFit, 1);
    found_.base = models_.fit_all({before->base}).front();
  }
  found_.best = found_.base;
  if (!found_.base.fit.finite) return std::move(found_);
  if (before != nullptr) take_up(before->sets);
  const auto room = [&] {
    const auto all = static_cast<int>(effects().size()), claimed = static_cast<int>(claims(effects()));
    return std::min(thresholds_.most_effects - claimed, thresholds_.most_effects + thresholds_.most_own_flow - all);
  };
  while (room() > 0 && goes_on()) {
    expect_rounds(std::min(2, room()));  // this one, and one that finds nothing
    if (!add_some()) break;
    drop();
  }
  expect_rounds(0);
  leave_out();
  judge_effects();
  // What gives way to something unlisted need not be told from other names.
  expect(kFreeForceFit, sought_ ? 1.0 : 1.0 + static_cast<double>(effects().size()));
  found_.free_force = free_force_beside(found_.best);
  if (!sought_) give_way();
  expect(kFreeForceFit, 0);
  if (!sought_ && swap()) {
    drop();
    leave_out();
    found_.free_force = free_force_beside(found_.best);
  }
  judge_effects();
  expect_rounds(0);
  list_refused();
  found_.near = models_.near(found_.best, kHardlyLess, kMostNear);
  found_.fits = models_.size();
  return std::move(found_);
}

void Searching::announce(const Progress& progress) {
  progress.expect(kCandidateFit.phase, kFitsOfWhole * kRoundsOfFit, kCandidateFit.weight);
  progress.expect(kScan.phase, 1, kScan.weight);
  progress.expect(kFreeForceFit.phase, 1, kFreeForceFit.weight);
}

likelihood::Fit Searching::fit_base() const {
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
  progress_.done(kBaseFit.phase);
  likelihood::Fitting fitting{problem_, ahead.hypothesis, ahead.noise, options};
  double rounds = 1.0;
  fitting.run([&] {
    progress_.done(kBaseFit.phase);
    rounds += 1.0;
    expect(kBaseFit, std::max(kRoundsOfBase - rounds, 1.0));
  });
  likelihood::Fit on = fitting.fit();
  return on.finite ? on : ahead;
}

void Searching::expect(const Step& step, double units) const { progress_.expect(step.phase, units, step.weight); }

void Searching::begin(const Step& step) const { progress_.begin(step.phase, step.what); }

void Searching::expect_rounds(double rounds) {
  models_.expect(rounds * (sought_ ? 1 : thresholds_.fits_per_round + thresholds_.pairs_per_round));
  expect(kScan, rounds);
}

bool Searching::goes_on() {
  if (!found_.cut_short && deadline_.over()) {
    found_.cut_short = true;
    found_.spent = deadline_.elapsed();
    found_.given = deadline_.seconds();
  }
  return !found_.cut_short;
}

const std::vector<model::ActiveEffect>& Searching::effects() const { return found_.best.fit.hypothesis.model.effects; }

model::ActiveEffect Searching::effect_of(std::size_t law, const std::vector<double>& theta) const {
  model::ActiveEffect active = laws_[law].seed;
  active.theta = theta;
  return active;
}

std::vector<Proposal> Searching::proposals(const Fitted& from, double least, bool with_pairs) {
  std::vector<Proposal> proposals;
  promised_.clear();
  unasked_.clear();
  const auto take = [&](const Scan& scan, const likelihood::Noise& noise) {
    const double best = scan.promises.empty() ? 0.0 : scan.promises.front().score;
    int singles = 0;
    std::map<std::string, int> of_name;
    for (const Promise& promise : scan.promises) {
      note(promise);
      const bool first = asked_first(laws_[promise.law]);
      if (promise.score < least || of_name[laws_[promise.law].name]++ > 0) continue;  // the best form of each
      const bool far = promise.score < kFarBehind * best;
      if (!first && (far || singles++ >= (sought_ ? 1 : thresholds_.fits_per_round))) {
        unasked_.push_back({promise.score, far, {{effect_of(promise.law, promise.theta)}, noise, false, {}}});
        continue;
      }
      proposals.push_back({{effect_of(promise.law, promise.theta)}, noise, first, {}});
      for (const std::vector<double>& theta : sought_ ? std::vector<std::vector<double>>{} : promise.also)
        proposals.back().also.push_back(effect_of(promise.law, theta));
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
  likelihood::Fit quiet = from.fit;
  if (quieten(seen, quiet)) {
    const Seen again = see(problem_, quiet, threads_);
    take(scan(problem_, again, laws_, thresholds_, threads_), quiet.noise);
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
  for (std::size_t k = 0, count = unlike.size(); k < count; ++k) {
    for (const model::ActiveEffect& active : std::vector{unlike[k].also})
      unlike.push_back({{active}, unlike[k].noise, unlike[k].first, {}});
  }
  return unlike;
}

std::vector<Start> Searching::starts(const likelihood::Hypothesis& from, const std::vector<Proposal>& proposals) const {
  std::vector<Start> starts(proposals.size());
  for_each_index(starts.size(), threads_, [&](std::size_t i) {
    starts[i] = start_of(problem_, laws_, from, proposals[i].added, proposals[i].noise);
  });
  return starts;
}

Start Searching::without(const Fitted& from, std::size_t effect) {
  Start start{from.fit.hypothesis, from.fit.noise};
  auto& effects = start.hypothesis.model.effects;
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(effect));
  return start;
}

bool Searching::take_best(std::vector<Fitted> fits) {
  std::ranges::sort(fits, std::greater{}, &Fitted::score);
  for (Fitted& fitted : fits) {
    if (!fitted.fit.finite || fitted.score < found_.best.score + thresholds_.name_odds) return false;
    if (given_up(fitted.names) || !counts(fitted)) continue;
    const std::vector<model::ActiveEffect> before = effects();
    found_.best = std::move(fitted);
    if (sought_) return true;
    simplify(before);
    seek_again(before);
    return true;
  }
  return false;
}

bool Searching::add_some() {
  const bool pairs = !sought_ && claims(effects()) + 2 <= static_cast<std::size_t>(thresholds_.most_effects);
  std::vector<Proposal> all = proposals(found_.best, thresholds_.score_worth, pairs), first;
  beside_.clear();
  for (const auto& [law, promise] : promised_) {
    double& most = beside_.try_emplace(laws_[law].name, promise.score).first->second;
    most = std::max(most, promise.score);
  }
  std::ranges::copy_if(all, std::back_inserter(first), &Proposal::first);
  std::erase_if(all, [](const Proposal& proposal) { return proposal.first; });
  const likelihood::Hypothesis from = found_.best.fit.hypothesis;
  if (take_best(models_.race(starts(from, first), {.from = found_.best.score}))) return true;
  std::vector<Fitted> fits = models_.race(starts(from, all), {.from = found_.best.score});
  double gained = 0.0;
  for (const Fitted& fitted : fits) gained = std::max(gained, fitted.score - found_.best.score);
  const Odds beaten{.from = found_.best.score, .to_beat = found_.best.score + gained};
  for (Fitted& fitted : models_.race(starts(from, hidden(all, gained)), beaten)) fits.push_back(std::move(fitted));
  return take_best(std::move(fits));
}

std::vector<Proposal> Searching::hidden(const std::vector<Proposal>& asked, double gained) const {
  std::vector<Unasked> order = unasked_;
  std::ranges::stable_sort(order, std::greater{}, &Unasked::promised);
  std::vector<Proposal> found;
  int far = 0;
  for (Unasked& one : order) {
    const auto same = [&](const Proposal& other) {
      return other.added.size() == 1 && other.added.front().effect == one.proposal.added.front().effect;
    };
    if (one.promised < gained &&
        (!one.far || one.promised < kFarBehind * gained || far++ >= thresholds_.fits_per_round))
      continue;
    if (std::ranges::none_of(asked, same) && std::ranges::none_of(found, same))
      found.push_back(std::move(one.proposal));
  }
  return found;
}

bool Searching::held(const std::vector<model::ActiveEffect>& effects, const model::ActiveEffect& active) {
  return std::ranges::any_of(
      effects, [&](const auto& other) { return other.effect == active.effect && other.variant == active.variant; });
}

bool Searching::counts(const Fitted& fitted) {
  const Seen seen = see(problem_, fitted.fit, threads_);
  const auto& those = seen.fit.hypothesis.model.effects;
  // Of two that came together it is not known which one the random force stood for.
  const auto fresh = std::ranges::count_if(those, [&](const auto& active) { return !held(effects(), active); });
  for (std::size_t e = 0; e < those.size(); ++e) {
    if (held(effects(), those[e])) continue;
    const double size = size_of(seen, e, fresh == 1 && those.size() > effects().size() ? &found_.best : nullptr).share;
    const bool at_limit = stopped(those[e], scene_);
    if (!at_limit && (size >= thresholds_.smallest_size || by_nature(those[e]))) continue;
    failed_[std::string(those[e].effect->name())] =
        at_limit ? Refusal{Rule::kBound, fitted.score - found_.best.score, thresholds_.name_odds}
                 : Refusal{Rule::kSize, size, thresholds_.smallest_size};
    if (!at_limit) small_.insert(fitted.names);
    return false;
  }
  return true;
}

void Searching::quiet(likelihood::Fit& fit) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i)
    fit.noise[i].log[likelihood::kForce] -= std::log(kLouder);
}

bool Searching::quieten(const Seen& seen, likelihood::Fit& fit) const {
  bool large = false;
  for (int i = 0; i < problem_.simulated; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    large =
        large || (fit.noise[axis][likelihood::kForce] > thresholds_.large_random * seen.applied[problem_.axes[axis]] &&
                  fit.noise[axis][likelihood::kForceMemory] > thresholds_.swallowing_memory);
  }
  if (large) quiet(fit);
  return large;
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
