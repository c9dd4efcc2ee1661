// An effect that the diagnoser accepts again and again enters the model; one that it no longer sees leaves it.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/identification/identifier.hpp"
#include "common/model/effect_size.hpp"
#include "common/model/onset.hpp"
#include "common/model/open_scene.hpp"

namespace fathom::identification {
namespace {

constexpr int kRounds = 6;             // of learning anew around the last numbers: effects are not linear in theirs
constexpr double kSmallestMass = 0.1;  // of the prior mean: keeps a poor first estimate physical
constexpr double kFewest = 5.0;        // residuals before anything is said of them
constexpr double kLargestRatio = 2.0;  // of the residual's power to that of the stated noise, as for leaving a mode
constexpr double kPresent = 3.0;       // sigmas from zero: smaller, and the effect may as well be absent
constexpr double kTold = 3.0;          // log likelihood ratio from which two forms are told apart
constexpr double kMoved = 1.0;         // sigmas that a number may go from where the effect was linearised
constexpr std::array kShares{1.0, 0.5, 0.25, 0.1};  // of the way to the new numbers
constexpr double kHeld = 1e-6;                      // of a number's prior sigma, where it shall stay
constexpr double kGain = 1.0;                       // of twice the log likelihood, which a step must bring
constexpr double kMomentWithin = 0.06;              // of the trial, to either side of what the diagnoser says
constexpr double kMomentKnown = 0.1;                // s

void keep_inside(model::ActiveEffect& effect, const model::Vehicle& vehicle) {
  const auto parameters = model::parameters_of(*effect.effect, effect.variant, vehicle);
  for (std::size_t i = 0; i < effect.theta.size(); ++i)
    effect.theta[i] = std::clamp(effect.theta[i], parameters[i].low, parameters[i].high);
}

}  // namespace

void Identifier::keep(const EffectSample& sample) {
  if (settings_.adopt_after <= 0) return;
  kept_.push_back(sample);
  while (seconds_between(kept_.front().utime, sample.utime) > settings_.keep) kept_.pop_front();
}

void Identifier::hear(const EffectRanking& ranking) {
  if (settings_.adopt_after <= 0) return;
  if (!rankings_.empty() && ranking.utime <= rankings_.back().utime) return;
  rankings_.push_back(ranking);
}

// By time stamps alone, so that it does not matter when a ranking arrived.
void Identifier::weigh(Utime utime) {
  while (!rankings_.empty() && seconds_between(rankings_.front().utime, utime) >= settings_.adopt_delay) {
    const EffectRanking ranking = std::move(rankings_.front());
    rankings_.pop_front();
    if (ranking.verdict == "collecting") continue;
    without_ = ranking.verdict == "adequate" ? without_ + 1 : 0;
    if (track_ && without_ >= settings_.adopt_after && vanishes()) drop();
    if (ranking.verdict != "effect" || ranking.candidates.empty()) {
      in_a_row_ = 0;
      continue;
    }
    const EffectEvidence& best = ranking.candidates.front();
    in_a_row_ = best.name == leader_.name && best.variant == leader_.variant ? in_a_row_ + 1 : 1;
    leader_ = best;
    if (in_a_row_ >= settings_.adopt_after) adopt(best);
  }
}

void Identifier::adopt(const EffectEvidence& found) {
  if (resumed_) return;  // what was learnt before the restart is not kept as motion, so it cannot be learnt anew
  const model::Effect* effect = model::find_effect(found.name);
  if (effect == nullptr || effect->measures() || found.numbers.size() != effect->parameters().size()) {
    ++rejected_["effect not adoptable"];
    return;
  }
  const bool wrench = input_ == InputKind::kWrench;
  const std::vector<std::string> variants = effect->variants(model::open_scene(*vehicle_, wrench));
  const auto variant = std::find(variants.begin(), variants.end(), found.variant);
  const auto number = static_cast<int>(variant - variants.begin());
  if (variant == variants.end() || parameters_.size() + effect->sought(number).size() > kMaxParameters) {
    ++rejected_["effect not adoptable"];
    return;
  }
  const bool known = track_ && track_->effect().effect == effect;
  if (known && (track_->effect().variant == number || stands_for_ == number)) {
    if (moved() >= kMoved) (void)relearn();
    return;
  }
  model::ActiveEffect first{.effect = effect, .variant = number, .variant_name = found.variant, .theta = found.numbers};
  stands_for_ = -1;
  if (!try_on(std::move(first))) {
    ++rejected_["effect leaves a residual"];
    drop();
    return;
  }
  const auto plain = std::find(variants.begin(), variants.end(), "");
  if (plain != variants.end() && plain != variant) prefer(static_cast<int>(plain - variants.begin()));
}

// Learnt anew with it in the model; whether it leaves no more than noise.
bool Identifier::try_on(model::ActiveEffect effect) {
  keep_inside(effect, *vehicle_);
  find_moment(effect);
  follow(std::move(effect), estimator_.projected().head(static_cast<Eigen::Index>(parameters_.size())));
  learn_anew();
  for (int round = 1; round < kRounds && relearn(); ++round) continue;
  return explains();
}

// The moment of a change is found where the fit is best with it held: its derivative is zero but for an instant, so
// that no step leads there from afar. Misfit grows with every row between the moment and the true one: by golden
// section. The diagnoser's moments are a tenth of the trial apart.
void Identifier::find_moment(model::ActiveEffect& effect) {
  const auto parameters = effect.effect->parameters();
  const auto found = std::ranges::find(parameters, model::kOnset, &model::EffectParameter::name);
  if (found == parameters.end() || kept_.empty()) return;
  double& moment = effect.theta[static_cast<std::size_t>(found - parameters.begin())];
  const ParameterVector base = estimator_.projected().head(static_cast<Eigen::Index>(parameters_.size()));
  const double first = seconds_between(origin_, kept_.front().utime),
               last = seconds_between(origin_, kept_.back().utime);
  const auto cost_at = [&](double t) {
    moment = t;
    follow(effect, base);
    learn_anew(Held::kMoment);
    return cost_;
  };
  constexpr double kGolden = 0.618034;
  const double around = kMomentWithin * (last - first);
  double low = std::max(moment - around, first), high = std::min(moment + around, last);
  if (high - low <= kMomentKnown) return;  // before all that is kept
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = cost_at(left), at_right = cost_at(right);
  while (high - low > kMomentKnown) {
    if (at_left < at_right) {
      high = std::exchange(right, left);
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = cost_at(left);
    } else {
      low = std::exchange(left, right);
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = cost_at(right);
    }
  }
  moment = 0.5 * (low + high);
}

// The effect's ordinary form with no more numbers, where it leaves no more than noise either and the motion does not
// tell them apart: a named form may have found another vehicle. Heave behind a lag T of mass m and drag D is heave
// behind a lag m / D of mass T D. The ratio of their squares is judged with one independent row per window.
void Identifier::prefer(int plain) {
  const model::ActiveEffect named = track_->effect();
  const ParameterVector base = linearised_at_;
  const double cost = cost_;
  if (named.effect->numbers(plain) > named.effect->numbers(named.variant)) return;
  model::ActiveEffect ordinary{.effect = named.effect, .variant = plain, .variant_name = "", .theta = named.theta};
  for (std::size_t i = 0; i < ordinary.theta.size(); ++i) {
    if (!named.effect->takes_part(plain, i)) ordinary.theta[i] = 0.0;
  }
  const bool leaves_nothing = try_on(std::move(ordinary));
  const double rows = static_cast<double>(estimator_.state().updates) * settings_.stride / settings_.window;
  if (leaves_nothing && 0.5 * rows * std::log(cost_ / cost) < kTold) {
    stands_for_ = named.variant;
    return;
  }
  follow(named, base);
  learn_anew();
}

// How far the numbers are, in sigmas, from where the effect was linearised, or from where that led to nothing.
double Identifier::moved() const {
  const RecursiveReport report = estimator_.report();
  const auto base = static_cast<Eigen::Index>(parameters_.size());
  double moved = 0.0;
  for (std::size_t i = 0; i < track_->sought().size(); ++i) {
    const Eigen::Index k = base + static_cast<Eigen::Index>(i);
    const double from = stuck_at_.empty() ? track_->effect().theta[track_->sought()[i]] : stuck_at_[i];
    moved = std::max(moved, std::abs(report.estimate(k) - from) / report.sigma(k));
  }
  return moved;
}

// Linearised anew where its numbers have gone, or part of the way there: effects are not linear in theirs, and a number
// that the motion hardly shows goes anywhere. Steps are judged with the numbers held, so that no promise counts. False
// when nothing fits better; then the effect stays where it was.
bool Identifier::relearn() {
  const auto base = static_cast<Eigen::Index>(parameters_.size());
  const model::ActiveEffect at = track_->effect();
  const std::vector<std::size_t> sought = track_->sought();
  const ParameterVector estimate = estimator_.projected();
  const ParameterVector linearised_at = linearised_at_;
  const double cost = cost_with(at, linearised_at);
  for (const double share : kShares) {
    model::ActiveEffect next = at;
    for (std::size_t i = 0; i < sought.size(); ++i) {
      double& number = next.theta[sought[i]];
      number += share * (estimate(base + static_cast<Eigen::Index>(i)) - number);
    }
    keep_inside(next, *vehicle_);
    if (cost_with(next, estimate.head(base)) > cost - kGain) continue;
    follow(std::move(next), estimate.head(base));
    learn_anew();
    return true;
  }
  follow(at, linearised_at);
  learn_anew();
  stuck_at_.assign(estimate.data() + base, estimate.data() + base + static_cast<Eigen::Index>(sought.size()));
  return false;
}

double Identifier::cost_with(const model::ActiveEffect& effect, const ParameterVector& base) {
  follow(effect, base);
  learn_anew(Held::kEffect);
  return cost_;
}

// Whether what the effect leaves is what noise makes: the wrong name may explain much, but hardly ever all. One that
// takes an axis away leaves nothing there: without its thrust, its mass, drag and weight are zero, and so is the
// residual.
bool Identifier::explains() const {
  const RecursiveReport report = estimator_.report();
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (model::sign_constraint(parameters_[i]) > 0 &&
        report.estimate(k) + kPresent * report.sigma(k) < kSmallestMass * vehicle_->priors[i].mean)
      return false;
  }
  if (track_) {
    const model::ActiveEffect& effect = track_->effect();
    for (const double doubts : {0.0, -1.0, 1.0}) {
      std::vector<double> numbers = effect.theta;
      for (std::size_t i = 0; i < track_->sought().size(); ++i) {
        const auto k = static_cast<Eigen::Index>(parameters_.size() + i);
        numbers[track_->sought()[i]] = report.estimate(k) + doubts * report.sigma(k);
      }
      if (model::stopped_at_limit(*effect.effect, effect.variant, numbers, *vehicle_)) return false;
    }
  }
  return std::all_of(recent_.begin(), recent_.end(),
                     [](const Recent& r) { return r.weight < kFewest || r.square < kLargestRatio; });
}

void Identifier::follow(model::ActiveEffect effect, const ParameterVector& base) {
  linearised_at_ = base;
  stuck_at_.clear();
  track_ = std::make_unique<EffectTrack>(base_model(base), std::move(effect), parameters_, origin_,
                                         regressor_.capacity(), settings_.max_gap);
}

// Whether what was learnt of the effect's size is compatible with its absence.
bool Identifier::vanishes() const {
  const RecursiveReport report = estimator_.report();
  const model::ActiveEffect& effect = track_->effect();
  const auto sizes =
      effect.effect->amplitudes() > 0 ? static_cast<std::size_t>(effect.effect->amplitudes()) : effect.theta.size();
  for (std::size_t i = 0; i < track_->sought().size(); ++i) {
    if (track_->sought()[i] >= sizes) continue;
    const auto k = static_cast<Eigen::Index>(parameters_.size() + i);
    if (std::abs(report.estimate(k)) > kPresent * report.sigma(k)) return false;
  }
  return true;
}

void Identifier::drop() {
  if (resumed_) return;
  track_.reset();
  stands_for_ = -1;
  in_a_row_ = 0;
  learn_anew();
}

// From the prior through all that is kept; parameters that are paused are paused again at the end.
void Identifier::learn_anew(Held held) {
  RecursiveSettings settings = estimator_settings(adopted());
  const auto base = static_cast<Eigen::Index>(parameters_.size());
  for (Eigen::Index k = base; held != Held::kNothing && k < settings.sigma.size(); ++k) {
    const std::size_t place = track_->sought()[static_cast<std::size_t>(k - base)];
    const bool moment = track_->effect().effect->parameters()[place].name == model::kOnset;
    if (held == Held::kEffect || moment) settings.sigma[k] *= kHeld;
  }
  estimator_ = RecursiveEstimator{std::move(settings)};
  regressor_.reset();
  recent_ = {};
  misfit_ = Misfit{estimator_.size()};
  cost_ = 0.0;
  for (const EffectSample& sample : kept_) {
    const std::optional<RowBlock> block = rows_of(sample);
    if (!block) continue;
    estimator_.step(block->view());
    remember(*block);
  }
  for (const std::string& name : frozen_) freeze(name);
}

model::Model Identifier::base_model(const ParameterVector& estimate) const {
  model::Model model = model::nominal_model(*vehicle_, input_ == InputKind::kWrench);
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    double value = estimate(static_cast<Eigen::Index>(i));
    const double mean = vehicle_->priors[i].mean;
    if (model::sign_constraint(parameters_[i]) > 0) value = std::max(value, kSmallestMass * mean);
    if (model::sign_constraint(parameters_[i]) < 0) value = std::min(value, 0.0);
    model.theta[model::index(parameters_[i])] = value;
  }
  return model;
}

void Identifier::add_effect(ModelEstimate& estimate, const RecursiveReport& report) const {
  if (!track_) return;
  const model::ActiveEffect& effect = track_->effect();
  const std::string name{effect.effect->name()};
  estimate.effects.push_back(name);
  const auto parameters = effect.effect->parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!effect.effect->is_told(effect.variant, i)) continue;
    const auto sought = std::ranges::find(track_->sought(), i);
    const bool given = sought == track_->sought().end();
    const auto k = static_cast<Eigen::Index>(parameters_.size()) + (sought - track_->sought().begin());
    estimate.effect_numbers.push_back({.name = name + "." + std::string{parameters[i].name},
                                       .value = given ? effect.theta[i] : report.estimate(k),
                                       .std = given ? 0.0 : std::hypot(report.sigma(k), parameters[i].form_sigma),
                                       .unit = std::string{effect.effect->unit(effect.variant, i)}});
  }
}

}  // namespace fathom::identification
