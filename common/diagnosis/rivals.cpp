#include "common/diagnosis/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/diagnosis/evidence.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kSurely = 2.0;     // standard deviations
constexpr double kSameStory = 0.5;  // correlation of what two forms of one effect claim

/// Of all windows, weighted as in the fit.
Eigen::VectorXd residuals(const TrajectoryFit& problem, const FitResult& fit) {
  Eigen::Index rows = 0;
  for (const auto& window : problem.windows()) rows += window.rows();
  Eigen::VectorXd all(rows), own;
  model::VelocityTrace trace;
  rows = 0;
  for (std::size_t w = 0; w < problem.windows().size(); ++w) {
    own.resize(problem.windows()[w].rows());
    problem.windows()[w].evaluate(fit.model, fit.nu0[w], fit.sigma, trace, own);
    all.segment(rows, own.size()) = own;
    rows += own.size();
  }
  return all;
}

void add_name(std::vector<std::string>& names, const std::string& name) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

/// The likeliest form of an effect stands for it.
void add(std::vector<Alternative>& alternatives, Alternative one) {
  const auto same = std::ranges::find(alternatives, one.name, &Alternative::name);
  if (same == alternatives.end()) {
    alternatives.push_back(std::move(one));
  } else if (one.log_odds < same->log_odds) {
    *same = std::move(one);
  }
}

/// The longest time after a command among the numbers, s; 0 where none is one.
double time_after_command(const model::Effect& effect, int variant, std::span<const double> theta) {
  double longest = 0.0;
  const auto numbers = effect.parameters();
  for (std::size_t i = 0; i < theta.size(); ++i) {
    if (numbers[i].after_command && effect.takes_part(variant, i)) longest = std::max(longest, std::abs(theta[i]));
  }
  return longest;
}

double time_after_command(const model::Model& model, const model::Effect* effect, int variant) {
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect == effect && active.variant == variant) return time_after_command(*effect, variant, active.theta);
  }
  return 0.0;
}

/// How thrust builds up within a step is not followed: of two times after a command that are both shorter, neither
/// fit's cost says which it is.
bool within_a_step(double one, double other, double step) {
  return one > 0.0 && other > 0.0 && std::max(one, other) < step;
}

std::string falsified(const std::string& parameter, double share) {
  if (parameter.empty()) return "no base number";
  if (share < -1.0) return parameter + ", even in its sign";
  char text[32];
  std::snprintf(text, sizeof text, " by %+.0f %%", 100.0 * share);
  return parameter + text;
}

}  // namespace

BaseNumbers::BaseNumbers(const TrajectoryFit& problem, FitResult without) : without_{std::move(without)} {
  problem.add_covariance(without_);
}

Corruption BaseNumbers::most_moved(const model::Model& without, const model::Model& with) const {
  const identification::ParameterMap map{without_.model};
  Corruption most;
  for (std::size_t i = 0; i < map.size() && map[i].base >= 0; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const int base = map[i].base;
    const double moved = without.theta[base] - with.theta[base];
    if (with.theta[base] == 0.0 || std::abs(moved) < kSurely * std::sqrt(without_.covariance(k, k))) continue;
    const double share = moved / with.theta[base];
    if (std::abs(share) > std::abs(most.share)) most = {map[i].name, share};
  }
  return most;
}

double log_odds_over(std::span<const double> other, int other_numbers, std::span<const double> chosen,
                     int chosen_numbers) {
  const double dearer = price(chosen_numbers, static_cast<double>(chosen.size()), 1) -
                        price(other_numbers, static_cast<double>(other.size()), 1);
  const double fits = total(other) >= total(chosen) ? robust_log_likelihood_ratio(other, chosen)
                                                    : -robust_log_likelihood_ratio(chosen, other);
  return std::max(fits - std::max(dearer, 0.0), 0.0);
}

double log_odds_among(double log_odds, std::span<const Alternative> alternatives) {
  double against = std::exp(-log_odds);
  for (const Alternative& other : alternatives) against += std::exp(-other.log_odds);
  return alternatives.empty() ? log_odds : -std::log(against);
}

void find_aliases(Judged& winner, const Screened& best, const Answers& answers, const BaseNumbers& numbers,
                  const model::Model& near, double step, const Settings& settings) {
  const double own_time = time_after_command(*best.effect, best.variant, best.theta);
  for (std::size_t i = 0; i < answers.near.size(); ++i) {
    const Screened& other = answers.near[i];
    const std::string name{other.effect->name()};
    if (other.signature.size() != best.signature.size()) continue;
    const double between = robust_log_likelihood_ratio(other.window_cost, best.window_cost);
    if (other.effect == best.effect) {
      if (other.variant != best.variant && other.signature.dot(best.signature) > kSameStory &&
          between < kAlternativeLogOdds)
        winner.other_forms.push_back(other.variant_name);
      continue;
    }
    if (other.signature.dot(best.signature) < settings.alias_correlation) continue;
    add_name(winner.aliased_with, name);
    const bool even = within_a_step(own_time, time_after_command(*other.effect, other.variant, other.theta), step);
    if (!answers.judged[i].reason.empty() || (between >= kAlternativeLogOdds && !even)) continue;
    const Corruption moved = numbers.most_moved(near, other.base);
    const double odds = log_odds_over(other.window_cost, other.effect->numbers(other.variant), best.window_cost,
                                      best.effect->numbers(best.variant));
    add(winner.alternatives, {name, even ? 0.0 : odds, moved.parameter, moved.share});
  }
}

void find_rivals(Judged& winner, const FitResult& fit, const std::map<std::size_t, FitResult>& stands,
                 const Answers& answers, const BaseNumbers& numbers, const TrajectoryFit& problem,
                 const Settings& settings) {
  const FitResult& reference = numbers.fit();
  const Corruption own_moved = numbers.most_moved(reference.model, fit.model);
  winner.corrupts = own_moved.parameter;
  winner.corruption = own_moved.share;
  const Eigen::VectorXd without = residuals(problem, reference);
  const Eigen::VectorXd own = residuals(problem, fit) - without;
  const double step = problem.windows()[0].window().trial->dt;
  const double own_time = time_after_command(fit.model, winner.effect, winner.variant);
  for (const auto& [place, other] : stands) {
    const Screened& screened = answers.near[place];
    if (screened.effect == winner.effect) continue;
    const Eigen::VectorXd change = residuals(problem, other) - without;
    if (change.dot(own) < settings.alias_correlation * change.norm() * own.norm()) continue;
    const std::string name{screened.effect->name()};
    add_name(winner.aliased_with, name);
    const bool even = within_a_step(own_time, time_after_command(other.model, screened.effect, screened.variant), step);
    if (robust_log_likelihood_ratio(other.window_cost, fit.window_cost) >= kAlternativeLogOdds && !even) continue;
    const Corruption moved = numbers.most_moved(reference.model, other.model);
    const double odds = log_odds_over(other.window_cost, screened.effect->numbers(screened.variant), fit.window_cost,
                                      winner.effect->numbers(winner.variant));
    add(winner.alternatives, {name, even ? 0.0 : odds, moved.parameter, moved.share});
  }
}

std::string odds_sentence(const EffectFound& effect) {
  std::string text, harms;
  char odds[32];
  for (const Alternative& other : effect.alternatives) {
    std::snprintf(odds, sizeof odds, "%.2g", std::exp(other.log_odds));
    text += (text.empty() ? "" : ", ") + std::string(odds) + " to 1 against " + other.name;
    harms += ", " + other.name + " " + falsified(other.corrupts, other.corruption);
  }
  if (text.empty()) return "";
  return "The odds for " + effect.name + " are " + text + "; left out of a model, " + effect.name + " falsifies " +
         falsified(effect.corrupts, effect.corruption) + harms + ". ";
}

}  // namespace fathom::diagnosis
