#include "common/learning/learn.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/base/factors.hpp"
#include "common/learning/formula.hpp"
#include "common/learning/inner_numbers.hpp"
#include "common/learning/left_out.hpp"
#include "common/learning/seek_force.hpp"
#include "common/learning/steps.hpp"
#include "common/learning/wording.hpp"
#include "common/model/rollout.hpp"

namespace fathom::learning {
namespace {

using likelihood::Fit;
using likelihood::Problem;

constexpr double kVisitedShare = 0.998;  // of the samples: what is larger may be a spike

bool passes(const residual::Ratio& ratio, double most, const Limits& limits) {
  return ratio.windows >= limits.fewest_windows && ratio.value <= most &&
         std::log(ratio.value) + limits.sure * ratio.log_error < 0.0;
}

/// Numbers that predict ten seconds, where they do so no worse than those of one step.
Fit reported(const Problem& problem, std::span<const Trial> trials, const Fit& fit, const model::Visited& visited,
             const Leaving& leaving, int threads) {
  const Fit far = likelihood::fit(problem, fit.hypothesis, fit.noise,
                                  {.noise_rounds = 1,
                                   .steps = 3,
                                   .enough = 1.0,
                                   .fit_noise = false,
                                   .horizon = likelihood::Horizon{},
                                   .threads = threads});
  if (!far.finite) return fit;
  const auto near_force = made(fit, fit.hypothesis.force, visited),
             far_force = made(far, far.hypothesis.force, visited);
  const residual::Ratio ratio =
      error_over(as_model(fit.hypothesis, problem.input_step, near_force.get()),
                 as_model(far.hypothesis, problem.input_step, far_force.get()), trials, leaving.predicted);
  return ratio.value <= 1.0 ? far : fit;
}

void describe(const Fit& fit, const model::Visited& visited, CorrectionGiven& given) {
  const model::FreeForce& force = fit.hypothesis.force;
  std::vector<Eigen::Index> at;
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    if (fit.numbers[j].kind == likelihood::NumberKind::kWeight) at.push_back(static_cast<Eigen::Index>(j));
  }
  const Eigen::MatrixXd covariance = inverse_symmetric(fit.information);
  for (const model::FeatureGroup& group : force.groups) {
    for (int j = group.first; j < group.first + group.count; ++j) {
      const auto k = static_cast<std::size_t>(j);
      const model::Feature& feature = force.features[k];
      CorrectionTerm term{.group = group.kind,
                          .axis = feature.axis,
                          .scale = feature.scale,
                          .weight = force.weights[k],
                          .law = group.closed};
      if (k < at.size()) term.sigma = std::sqrt(std::max(covariance(at[k], at[k]), 0.0));
      for (int f = 0; f < feature.count; ++f) {
        const model::Factor& factor = feature.factors[static_cast<std::size_t>(f)];
        term.factors.push_back({std::string{word(factor.quantity)}, factor.index, factor.bank, factor.a, factor.b,
                                factor.c, factor.d, factor.column});
      }
      given.terms.push_back(std::move(term));
    }
  }
  for (const Eigen::Index i : at) {
    given.covariance.emplace_back();
    for (const Eigen::Index j : at) given.covariance.back().push_back(covariance(i, j));
  }
  for (std::size_t i = 0; i < 6; ++i) {
    given.visited_nu[i] = visited.nu[static_cast<Eigen::Index>(i)];
    given.visited_tau[i] = visited.tau[static_cast<Eigen::Index>(i)];
  }
  given.visited_force.assign(visited.force.begin(), visited.force.end());
  for (std::size_t i = 0; i < 3; ++i) {
    given.visited_low[i] = visited.p_low[static_cast<Eigen::Index>(i)];
    given.visited_high[i] = visited.p_high[static_cast<Eigen::Index>(i)];
  }
}

}  // namespace

model::Model as_model(const likelihood::Hypothesis& hypothesis, double input_step, const model::LearnedForce* force) {
  model::Model model = likelihood::model_of(hypothesis, input_step);
  if (force != nullptr && !force->force().empty()) model.add({.effect = force});
  return model;
}

model::Visited visited_by(const Problem& problem, const likelihood::Hypothesis& hypothesis) {
  model::Visited visited;
  visited.force.setZero(hypothesis.model.allocation.cols());
  visited.p_low.setConstant(1e300);
  visited.p_high.setConstant(-1e300);
  std::array<std::vector<double>, 6> sizes;
  const std::vector<likelihood::Number> none;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    const likelihood::RunData& run = problem.runs[r];
    likelihood::Plant plant{hypothesis, none, run, r, false};
    const Eigen::MatrixXd& forces = plant.mean_forces();
    visited.force = visited.force.cwiseMax(forces.cwiseAbs().rowwise().maxCoeff());
    visited.tau = visited.tau.cwiseMax((hypothesis.model.allocation * forces).cwiseAbs().rowwise().maxCoeff());
    for (std::size_t k = 0; k < run.trial().size(); ++k) {
      plant.at_substep(std::min(k, run.intervals().size() - 1), 0);
      const Vector6d nu = plant.features_at(run.trial().nu[k], false).nu;
      for (std::size_t i = 0; i < 6; ++i) sizes[i].push_back(std::abs(nu[static_cast<Eigen::Index>(i)]));
      visited.p_low = visited.p_low.cwiseMin(run.trial().p_WB[k]);
      visited.p_high = visited.p_high.cwiseMax(run.trial().p_WB[k]);
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    if (sizes[i].empty()) continue;
    const auto place = static_cast<std::ptrdiff_t>(kVisitedShare * static_cast<double>(sizes[i].size() - 1));
    std::ranges::nth_element(sizes[i], sizes[i].begin() + place);
    visited.nu[static_cast<Eigen::Index>(i)] = sizes[i][static_cast<std::size_t>(place)];
  }
  return visited;
}

Learned learn(const Problem& problem, std::span<const Trial> of, const inference::Conclusion& conclusion,
              const Settings& settings, bool judged_here, int threads, const Progress& progress) {
  Learned learned;
  CorrectionGiven& given = learned.given;
  const Limits& limits = settings.limits;
  const bool lacking =
      conclusion.verdict == inference::Verdict::unexplained || conclusion.verdict == inference::Verdict::no_model;
  if (!settings.learn || !conclusion.found.best.fit.finite || !lacking) return learned;
  const Fit& base = conclusion.found.best.fit;
  const model::Scene scene = model::scene_of(*problem.vehicle, of);
  std::optional<inference::FreeForceFound> free = conclusion.found.free_force, lasting;
  if (!conclusion.found.cut_short) {
    Sought sought = seek_force(problem, base, scene, limits, threads, progress, inference::stretches_of(problem, {}));
    if (sought.all.fit.finite && !(free && free->fit.finite && free->log_odds > sought.all.log_odds))
      free = std::move(sought.all);
    if (sought.lasting.fit.finite) lasting = std::move(sought.lasting);
  } else {
    progress.expect(kSeek.phase, 0);
  }
  if (!free || !free->fit.finite) return learned;
  given.asked = true;
  given.log_odds = free->log_odds;
  given.size = free->size.share;
  if (free->log_odds < limits.odds) {
    given.refused = too_little("log odds", free->log_odds, "at least", limits.odds);
  } else if (free->size.share < limits.size) {
    given.refused = too_little("its share of the applied acceleration", free->size.share, "at least", limits.size);
  }
  if (!given.refused.empty()) return learned;

  free->fit = with_inner_numbers(problem, std::move(free->fit), threads);
  const model::Visited visited = visited_by(problem, free->fit.hypothesis);
  const auto adopt = [&](const Fit& with) {
    given.refused.clear();
    const Judged judged = leave_out_in_turn(problem, of, base, with, visited, settings.leaving, threads, progress);
    const residual::Ratio whole = ratio_of(judged.whole), carried = ratio_of(judged.carried);
    given.held_out = whole.value;
    given.held_out_carried = carried.value;
    given.windows = whole.windows;
    given.shortened = judged.whole.shortened;
    if (whole.windows < limits.fewest_windows) {
      given.refused =
          too_little("predictions where it was not fitted", whole.windows, "at least", limits.fewest_windows);
    } else if (!passes(whole, limits.error, limits)) {
      given.refused = too_little("error where it was not fitted, over the model's without it", whole.value,
                                 "surely below", limits.error);
    }
    if (!given.refused.empty()) return false;
    begin(progress, inference::kHorizonFit, 1);
    Fit chosen = reported(problem, of, with, visited, settings.leaving, threads);
    progress.done(inference::kHorizonFit.phase);
    const auto here = made(chosen, chosen.hypothesis.force, visited);
    const Fit& plain = conclusion.reported.finite ? conclusion.reported : base;
    const residual::Ratio at_home =
        error_over(as_model(plain.hypothesis, problem.input_step),
                   as_model(chosen.hypothesis, problem.input_step, here.get()), of, settings.leaving.predicted);
    if (at_home.value > limits.error) {
      given.refused = too_little("error over the best numbers' without it", at_home.value, "at most", limits.error);
      return false;
    }
    given.adopted = true;
    learned.fit = std::move(chosen);
    learned.here = here;
    const model::FreeForce lasts = model::lasting_of(learned.fit.hypothesis.force);
    given.carried = !lasts.empty() && passes(carried, limits.carried, limits);
    if (given.carried) learned.elsewhere = made(learned.fit, lasts, visited);
    // A recording that goes on where these have ended finds what has begun and what has grown.
    learned.until = problem.t_high;
    const model::FreeForce standing = standing_of(problem, learned.fit.hypothesis.force);
    given.goes_on = standing.features.size() > model::without_time(learned.fit.hypothesis.force).features.size() &&
                    passes(ratio_of(judged.standing), limits.carried, limits);
    learned.later = given.goes_on ? made(learned.fit, standing, visited) : learned.elsewhere;
    return true;
  };
  // A law in closed form first, where it is as likely: it has fewer numbers to err with.
  std::optional<FormulaFound> formula = find_formula(problem, base, scene, *free, threads, progress);
  if (formula && (formula->over_learned < -limits.form || formula->over_base < limits.odds)) formula.reset();
  if (formula && !adopt(formula->fit)) formula.reset();
  if (!formula) (void)adopt(free->fit);
  // What holds on this recording alone helps no other: what lasts, found and fitted without it, may.
  if (lasting && !judged_here && !given.carried && !given.goes_on) {
    Learned alone = std::exchange(learned, {});
    given = {.asked = true, .log_odds = lasting->log_odds, .size = lasting->size.share};
    if (lasting->log_odds >= limits.odds && lasting->size.share >= limits.size && adopt(lasting->fit) &&
        given.carried) {
      free = std::move(lasting);
      formula.reset();
    } else {
      learned = std::move(alone);
    }
  }
  if (!given.adopted) return learned;
  if (!formula) formula = as_formula(*free);
  if (formula) given.formula = given_of(*formula);
  const Fit& with = formula ? formula->fit : free->fit;
  describe(with, visited, given);
  given.input_is_wrench = of.front().input_is_wrench;
  for (std::size_t k = 0; k < given.terms.size(); ++k) given.terms[k].weight = learned.fit.hypothesis.force.weights[k];
  for (const inference::RandomForce& random : conclusion.random) {
    const auto i = static_cast<std::size_t>(std::ranges::find(problem.axes, random.axis) - problem.axes.begin());
    if (i >= with.noise.size() || !(random.sigma > 0.0)) continue;
    given.left.push_back({model::kAxisNames[static_cast<std::size_t>(random.axis)],
                          random.share * with.noise[i][likelihood::kForce] / random.sigma, random.share});
  }
  given.look_for = look_for(*free);
  given.words = correction_sentence(*free, given);
  return learned;
}

}  // namespace fathom::learning
