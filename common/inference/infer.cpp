#include "common/inference/infer.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/statistics.hpp"
#include "common/model/rollout.hpp"

namespace fathom::inference {
namespace {

using likelihood::NumberKind;

/// Per simulated axis, the share of the filtered acceleration over a quarter of a second that the model foretells from
/// where the vehicle was. Below zero it would do better to foretell none.
std::vector<Following> followed(const likelihood::Problem& problem, const Seen& seen) {
  std::vector<Following> shares;
  for (int i = 0; i < problem.simulated; ++i) {
    const int axis = problem.axes[static_cast<std::size_t>(i)];
    double all = 0.0, left = 0.0;
    for (std::size_t r = 0; r < problem.runs.size(); ++r) {
      const auto& blocks = problem.runs[r].blocks();
      const likelihood::RunReference& reference = seen.reference[r];
      double span = 0.0, foretold = 0.0;
      std::size_t from = 0;
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (!blocks[b].scored || b == 0) {
          span = foretold = 0.0;
          from = b;
          continue;
        }
        span += blocks[b].dt;
        foretold += blocks[b].dt * reference.nu_dot(axis, static_cast<Eigen::Index>(b));
        if (span < likelihood::kAccelerationSpan) continue;
        const double moved = reference.nu_end(axis, static_cast<Eigen::Index>(b)) -
                             reference.nu_end(axis, static_cast<Eigen::Index>(from));
        all += moved * moved / span;
        left += (moved - foretold) * (moved - foretold) / span;
        span = foretold = 0.0;
        from = b;
      }
    }
    shares.push_back({all > 0.0 ? 1.0 - left / all : 1.0,
                      seen.applied[axis] / std::max(problem.acceleration[static_cast<std::size_t>(i)], 1e-9)});
  }
  return shares;
}

/// In standard deviations, the median over base numbers by which both scores differ.
double disagreement(const likelihood::Fit& one, const likelihood::Fit& other) {
  const Eigen::VectorXd sigma = one.sigma();
  std::vector<double> off;
  for (std::size_t j = 0; j < one.numbers.size() && j < other.numbers.size(); ++j) {
    if (one.numbers[j].kind != NumberKind::kBase) continue;
    const double difference = value(one.hypothesis, one.numbers[j]) - value(other.hypothesis, other.numbers[j]);
    off.push_back(std::abs(difference) / std::max(sigma[static_cast<Eigen::Index>(j)], 1e-12));
  }
  return median(std::move(off));
}

likelihood::Fit by_horizon(const likelihood::Problem& problem, const likelihood::Fit& fit, int threads) {
  likelihood::Fit reported = likelihood::fit(problem, fit.hypothesis, fit.noise,
                                             {.noise_rounds = 1,
                                              .steps = 3,
                                              .enough = 1.0,
                                              .fit_noise = false,
                                              .horizon = likelihood::Horizon{},
                                              .threads = threads});
  return reported.finite ? reported : fit;
}

double length_of(const likelihood::Problem& problem) {
  double length = 0.0;
  for (const likelihood::RunData& run : problem.runs) length += run.last_time() - run.first_time();
  return length;
}

}  // namespace

void conclude(const likelihood::Problem& problem, const Thresholds& thresholds, Conclusion& conclusion) {
  const Found& found = conclusion.found;
  auto& reasons = conclusion.reasons;
  const double length = length_of(problem);
  if (length < thresholds.shortest) {
    reasons.push_back({Cause::kTooShort, length, thresholds.shortest, ""});
    conclusion.verdict = Verdict::not_judged;
    return;
  }
  if (!found.best.fit.finite) {
    reasons.push_back({Cause::kNotFinite, 0.0, 0.0, ""});
    conclusion.verdict = Verdict::not_judged;
    return;
  }

  const likelihood::Fit& fit = found.best.fit;
  for (std::size_t axis = 0; axis < conclusion.followed.size(); ++axis) {
    const Following& following = conclusion.followed[axis];
    if (following.pushed >= thresholds.pushed && following.share < thresholds.following)
      reasons.push_back({Cause::kNotFollowing, following.share, thresholds.following,
                         model::kAxisNames[static_cast<std::size_t>(problem.axes[axis])]});
  }
  for (const likelihood::Number& number : fit.numbers) {
    if (number.kind != NumberKind::kBase) continue;
    const double size = std::abs(value(fit.hypothesis, number)) / (std::abs(number.mean) + number.sigma);
    const bool pinned = number.low > 0.0 && value(fit.hypothesis, number) <= number.low * (1.0 + 1e-9);
    if (size > thresholds.absurd || pinned)
      reasons.push_back({Cause::kAbsurdNumber, size, thresholds.absurd, number.name});
  }
  if (!reasons.empty()) {
    conclusion.verdict = Verdict::no_model;
    return;
  }

  if (conclusion.reported.finite) {
    const double off = disagreement(fit, conclusion.reported);
    if (off > thresholds.disagreement) reasons.push_back({Cause::kScoresDisagree, off, thresholds.disagreement, ""});
  }
  bool unexplained = false;
  if (found.free_force && found.free_force->log_odds >= thresholds.free_force_odds &&
      found.free_force->size.share >= thresholds.smallest_size) {
    std::string of;
    for (const GroupFound& group : found.free_force->groups) of += (of.empty() ? "" : "; ") + words(group);
    reasons.push_back({Cause::kFreeForce, found.free_force->log_odds, thresholds.free_force_odds, of});
    unexplained = true;
  }
  for (const RandomForce& force : conclusion.random) {
    if (force.memory <= thresholds.slow_memory || force.share <= thresholds.smallest_size) continue;
    reasons.push_back({Cause::kSlowRandomForce, force.memory, thresholds.slow_memory,
                       model::kAxisNames[static_cast<std::size_t>(force.axis)]});
    unexplained = true;
  }
  if (found.cut_short) reasons.push_back({Cause::kOutOfTime, found.spent, found.given, ""});
  // Odds of names are those of models that are complete; here none is, so none of them is a claim.
  if (unexplained) {
    conclusion.verdict = Verdict::unexplained;
    return;
  }
  if (!found.best.names.empty()) {
    const double least = *std::ranges::min_element(found.probability);
    const bool sure = least >= thresholds.name_probability;
    reasons.push_back({sure ? Cause::kNamed : Cause::kRivals, least, thresholds.name_probability, ""});
    conclusion.verdict = sure && !found.cut_short ? Verdict::effect : Verdict::ambiguous;
    return;
  }
  const double promised = found.refused.empty() ? 0.0 : found.refused.front().promised;
  reasons.push_back({Cause::kNothingFound, promised, thresholds.name_odds, ""});
  conclusion.verdict = found.cut_short ? Verdict::not_judged : Verdict::adequate;
}

Conclusion infer(const model::Vehicle& vehicle, std::span<const Trial> trials, const Settings& settings,
                 const Progress& progress) {
  const likelihood::Problem problem = likelihood::make_problem(vehicle, trials, settings.runs);
  const model::Scene scene = model::scene_of(vehicle, trials);
  Conclusion conclusion;
  if (length_of(problem) < settings.thresholds.shortest) {
    conclude(problem, settings.thresholds, conclusion);
    return conclusion;
  }
  progress.expect(kHorizonFit.phase, 1, kHorizonFit.weight);
  const Deadline deadline{settings.time_budget};
  conclusion.found =
      search(problem, scene, settings.without, settings.thresholds, settings.threads, progress, deadline);
  const Found& found = conclusion.found;
  if (found.best.fit.finite) {
    const Seen seen = see(problem, found.best.fit, settings.threads);
    // Where a force that goes with what was recorded does it, the model follows, and something beside it is not listed.
    const bool beside = found.free_force && found.free_force->fit.finite &&
                        found.free_force->log_odds >= settings.thresholds.free_force_odds;
    conclusion.followed =
        followed(problem, beside ? see(problem, found.free_force->fit, settings.threads) : Seen{seen});
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(problem.simulated); ++axis) {
      const likelihood::AxisNoise& noise = found.best.fit.noise[axis];
      const int of = problem.axes[axis];
      conclusion.random.push_back({of, noise[likelihood::kForce], noise[likelihood::kForceMemory],
                                   noise[likelihood::kForce] / std::max(seen.applied[of], 1e-9)});
    }
    // One fit gives all numbers: the likelihood's, which wastes nothing where the model is right, unless numbers that
    // predict far differ from it by more than chance: then those.
    const auto reported = [&](const likelihood::Fit& fit) {
      progress.begin(kHorizonFit.phase, kHorizonFit.what);
      likelihood::Fit by = deadline.over() ? fit : by_horizon(problem, fit, settings.threads);
      progress.done(kHorizonFit.phase);
      return disagreement(fit, by) > settings.thresholds.disagreement ? by : fit;
    };
    if (!found.best.names.empty()) progress.expect(kHorizonFit.phase, 2, kHorizonFit.weight);
    conclusion.reported = reported(found.best.fit);
    conclusion.reported_base = found.best.names.empty() ? conclusion.reported : reported(found.base.fit);
  }
  conclude(problem, settings.thresholds, conclusion);
  return conclusion;
}

}  // namespace fathom::inference
