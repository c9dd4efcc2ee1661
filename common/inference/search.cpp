#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/parallel.hpp"
#include "common/inference/searching.hpp"
#include "common/likelihood/fitting.hpp"

namespace fathom::inference {
namespace {

constexpr std::array kLeaning{1.0, 10.0};  // times the noise's prior mean, where the base model's fits begin
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
  grow(thresholds_.few_effects);
  const Fitted grown = found_.best;
  settle();
  if (static_cast<int>(claims(grown.fit.hypothesis.model.effects)) >= thresholds_.few_effects) go_beyond(grown, before);
  return std::move(found_);
}

void Searching::grow(int most) {
  const auto room = [&] {
    const auto all = static_cast<int>(effects().size()), claimed = static_cast<int>(claims(effects()));
    return std::min(most - claimed, most + thresholds_.most_own_flow - all);
  };
  while (room() > 0 && goes_on()) {
    expect_rounds(std::min(2, room()));  // this one, and one that finds nothing
    if (!add_some()) break;
    drop();
  }
  expect_rounds(0);
}

void Searching::settle() {
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
}

void Searching::go_beyond(const Fitted& grown, const Before* before) {
  Found few = found_;
  const std::map<std::string, double> in_place = in_place_;
  // Names that one likes best beside many that are missing lead astray: it goes on from what came by itself.
  found_.best = grown;
  if (!sought_) in_place_.clear();
  unnamed_ = worth(*few.free_force);
  if (before != nullptr) take_up(before->more);
  grow(thresholds_.most_effects);
  few.ended_as(found_);
  if (found_.best.score <= std::max(grown.score, few.best.score)) {
    found_ = std::move(few);
    in_place_ = in_place;
    return;
  }
  settle();
  found_.fewer = {std::move(few)};
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

double Searching::least_of_next() const { return kFarBehind * std::max(unnamed_, 0.0); }

bool Searching::take_best(std::vector<Fitted> fits) {
  std::ranges::sort(fits, std::greater{}, &Fitted::score);
  for (Fitted& fitted : fits) {
    const double gained = fitted.score - found_.best.score;
    if (!fitted.fit.finite || gained < std::max(thresholds_.name_odds, least_of_next())) return false;
    if (given_up(fitted.names) || !counts(fitted)) continue;
    const std::vector<model::ActiveEffect> before = effects();
    found_.best = std::move(fitted);
    unnamed_ -= gained;
    if (sought_) return true;
    simplify(before);
    seek_again(before);
    return true;
  }
  return false;
}

bool Searching::add_some() {
  // Beyond a few each comes by itself: of two at once the second is easily one that is not needed beside the first.
  const bool pairs = !sought_ && claims(effects()) + 2 <= static_cast<std::size_t>(thresholds_.few_effects);
  std::vector<Proposal> all = proposals(found_.best, std::max(thresholds_.score_worth, least_of_next()), pairs), first;
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

}  // namespace fathom::inference
