#include "common/learning/left_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/learning/inner_numbers.hpp"
#include "common/learning/learn.hpp"
#include "common/learning/steps.hpp"
#include "common/model/rollout.hpp"

namespace fathom::learning {
namespace {

using likelihood::Fit;
using likelihood::Problem;

constexpr double kLastPart = 0.25;  // of the recordings, over which what grows hardly changes

/// A stretch of a run that is left out together with others of its fold.
struct Stretch {
  std::size_t run{};
  double from{}, to{};  // s
  int fold{};
};

/// Stretches side by side, dealt out to the folds in turn; shorter ones where the recording is short.
std::vector<Stretch> stretches_of(const Problem& problem, const Leaving& leaving) {
  double whole = 0.0;
  for (const likelihood::RunData& run : problem.runs) whole += run.last_time() - run.first_time();
  const double length = std::min(leaving.stretch, whole / leaving.folds);
  std::vector<Stretch> stretches;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    const likelihood::RunData& run = problem.runs[r];
    const double span = run.last_time() - run.first_time();
    const int count = std::max(1, static_cast<int>(std::lround(span / length)));
    for (int i = 0; i < count; ++i) {
      stretches.push_back({r, run.first_time() + span * i / count, run.first_time() + span * (i + 1) / count,
                           static_cast<int>(stretches.size()) % leaving.folds});
    }
    stretches.back().to = run.last_time() + run.dt();
  }
  return stretches;
}

double last_part_of(const Problem& problem) { return problem.t_high - kLastPart * (problem.t_high - problem.t_low); }

bool reads(const model::Feature& feature, model::Quantity quantity) {
  return std::any_of(feature.factors.begin(), feature.factors.begin() + feature.count,
                     [&](const model::Factor& factor) { return factor.quantity == quantity; });
}

/// The latest moment of a group, if it is a law.
double begins(const model::FreeForce& force, const model::FeatureGroup& group) {
  double moment = std::numeric_limits<double>::lowest();
  for (int j = group.first; j < group.first + group.count && group.closed; ++j) {
    const model::Feature& feature = force.features[static_cast<std::size_t>(j)];
    for (int i = 0; i < feature.count; ++i) {
      const model::Factor& factor = feature.factors[static_cast<std::size_t>(i)];
      if (factor.quantity == model::Quantity::kAfter) moment = std::max(moment, factor.a + 0.5 * factor.b);
    }
  }
  return moment;
}

/// From when on what is told of later runs must hold: from the last moment at which something set in; where it grows,
/// on a last part.
double stands_from(const Problem& problem, const model::FreeForce& force) {
  double from = problem.t_low;
  for (const model::FeatureGroup& group : force.groups) {
    if (begins(force, group) <= last_part_of(problem)) from = std::max(from, begins(force, group));
  }
  const bool grows = std::ranges::any_of(
      force.features, [](const model::Feature& feature) { return reads(feature, model::Quantity::kRamp); });
  return grows ? last_part_of(problem) : from;
}

/// The two models' predictions on what was left out of a fit.
class Comparing {
 public:
  Comparing(const Problem& problem, const Fit& base, const model::Visited& visited, const Leaving& leaving)
      : problem_{problem},
        plain_{as_model(base.hypothesis, problem.input_step)},
        visited_{visited},
        leaving_{leaving} {}
  void operator()(const Fit& fitted, const model::FreeForce& force, std::span<const model::Window> on,
                  residual::Compared& compared) const {
    const auto learned = made(fitted, force, visited_);
    compare(plain_, as_model(fitted.hypothesis, problem_.input_step, learned.get()), on, leaving_.predicted, compared);
  }

 private:
  const Problem& problem_;
  model::Model plain_;
  const model::Visited& visited_;
  const Leaving& leaving_;
};

constexpr likelihood::FitOptions kAgain{.noise_rounds = 1, .steps = 2, .enough = 0.3, .fit_noise = false};

Fit fitted_to(const Problem& rest, const Fit& with, int threads) {
  likelihood::FitOptions options = kAgain;
  options.threads = threads;
  return likelihood::fit(rest, with.hypothesis, with.noise, options);
}

/// Whether it goes on as a law of the clock where its recordings end.
bool goes_on(const model::FreeForce& force) {
  return model::swings(force) || std::ranges::any_of(force.groups, [&](const model::FeatureGroup& group) {
           const auto first = force.features.begin() + group.first;
           return group.closed && std::any_of(first, first + group.count, [](const model::Feature& feature) {
                    return reads(feature, model::Quantity::kSettling);
                  });
         });
}

/// What swings or settles, beyond what it was fitted to.
void foretell(const Problem& problem, std::span<const Trial> trials, const Fit& with, const Leaving& leaving,
              int threads, const Comparing& comparing, residual::Compared& standing) {
  const double from = last_part_of(problem);
  Problem before = problem;
  std::vector<model::Window> windows;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    const double end = problem.runs[r].last_time() + problem.runs[r].dt();
    if (problem.runs[r].last_time() <= from) continue;
    before.runs[r].leave_out(std::max(from, problem.runs[r].first_time()), end);
    const auto within = windows_within(trials[r], std::max(from, trials[r].t.front()), end, leaving.predicted);
    windows.insert(windows.end(), within.begin(), within.end());
  }
  if (windows.empty()) return;
  Fit fitted = fitted_to(before, with, threads);
  if (!fitted.finite) return;
  fitted = with_inner_numbers(before, std::move(fitted), threads);
  comparing(fitted, standing_of(problem, fitted.hypothesis.force), windows, standing);
}

}  // namespace

Judged leave_out_in_turn(const Problem& problem, std::span<const Trial> trials, const Fit& base, const Fit& with,
                         const model::Visited& visited, const Leaving& leaving, int threads, const Progress& progress) {
  begin(progress, kLeftOut, leaving.folds + (goes_on(with.hypothesis.force) ? 1 : 0));
  const std::vector<Stretch> stretches = stretches_of(problem, leaving);
  const Comparing comparing{problem, base, visited, leaving};
  const double late = stands_from(problem, with.hypothesis.force);
  const bool foretold = goes_on(with.hypothesis.force);
  Judged judged;
  for (int fold = 0; fold < leaving.folds; ++fold) {
    if (fold > 0) progress.done(kLeftOut.phase);
    Problem rest = problem;
    std::vector<model::Window> windows, late_windows;
    for (const Stretch& stretch : stretches) {
      if (stretch.fold != fold) continue;
      rest.runs[stretch.run].leave_out(stretch.from, stretch.to);
      const auto take = [&](double from, std::vector<model::Window>& into) {
        const auto within = windows_within(trials[stretch.run], from, stretch.to, leaving.predicted);
        into.insert(into.end(), within.begin(), within.end());
      };
      take(stretch.from, windows);
      if (stretch.to > late && !foretold) take(std::max(stretch.from, late), late_windows);
    }
    if (windows.empty()) continue;
    const Fit fitted = fitted_to(rest, with, threads);
    if (!fitted.finite) continue;
    comparing(fitted, fitted.hypothesis.force, windows, judged.whole);
    comparing(fitted, model::lasting_of(fitted.hypothesis.force), windows, judged.carried);
    if (!late_windows.empty())
      comparing(fitted, standing_of(problem, fitted.hypothesis.force), late_windows, judged.standing);
  }
  progress.done(kLeftOut.phase);
  if (foretold) foretell(problem, trials, with, leaving, threads, comparing, judged.standing);
  progress.expect(kLeftOut.phase, 0);
  return judged;
}

model::FreeForce standing_of(const Problem& problem, const model::FreeForce& force) {
  const model::FreeForce judged = model::kept_of(force, [&](const model::FeatureGroup& group, const model::Feature&) {
    return begins(force, group) <= last_part_of(problem);
  });
  return model::as_it_stands(judged, problem.t_high);
}

std::shared_ptr<const model::LearnedForce> made(const Fit& fit, const model::FreeForce& force,
                                                const model::Visited& visited) {
  return std::make_shared<const model::LearnedForce>(force, visited, fit.hypothesis.model.allocation);
}

}  // namespace fathom::learning
