// Of what a residual may go with: what happened at a moment of its own, and what swings.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/diagnosis/associations.hpp"
#include "common/diagnosis/episode.hpp"
#include "common/diagnosis/oscillation.hpp"
#include "common/diagnosis/product_sums.hpp"
#include "common/diagnosis/words.hpp"

namespace fathom::diagnosis {
namespace {

using identification::LagSums;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMargin = 8.0;  // s that a step has before and after it at least
constexpr int kSteps = 40;       // moments that are asked, over all runs
constexpr double kChosen = 1.0;  // parameters that the choice of a step's moment, or of a frequency, counts for
constexpr int kHalfCycles = 12;  // in a run: what swings quicker stands out from its neighbours in the spectrum

double heading(const Moment& at) { return euler_from_rotation(at.trial.q_WB[at.k].toRotationMatrix()).z(); }

}  // namespace

Association LeftOver::step(int axis) const {
  struct Candidate {
    const Trial* trial;
    double t;
  };
  std::vector<Candidate> candidates;
  double duration = 0.0;
  for (const Run& run : runs_) duration += run.trial->t.back() - run.trial->t.front();
  const double apart = std::max(duration / kSteps, kMargin);
  for (const Run& run : runs_) {
    for (double t = run.trial->t.front() + kMargin; t < run.trial->t.back() - kMargin; t += apart)
      candidates.push_back({run.trial, t});
  }
  Association best{.axis = model::kAxisNames[static_cast<std::size_t>(axis)], .log_odds = -1.0};
  if (candidates.empty()) return best;
  const LagSums sums = sums_of(rows(axis, always, [&](const Moment& at, Columns& row) {
    for (const Candidate& one : candidates)
      row.push_back(&at.trial == one.trial && at.trial.t[at.k] >= one.t ? 1.0 : 0.0);
  }));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Answer told = answer(sums, {kBaseColumns + static_cast<Eigen::Index>(i)}, kChosen);
    if (told.log_odds <= best.log_odds) continue;
    best.with =
        with_number("a step at %.0f s", candidates[i].t) + (runs_.size() > 1 ? " of " + candidates[i].trial->name : "");
    best.share = told.share;
    best.log_odds = told.log_odds;
  }
  return best;
}

Association LeftOver::swing(int axis) const {
  Association best{.axis = model::kAxisNames[static_cast<std::size_t>(axis)], .log_odds = -1.0};
  const auto with_attitude = [](const Trial& trial) { return trial.observed.attitude; };
  for (const Run& run : runs_) {
    const Trial& trial = *run.trial;
    const double length = trial.t.back() - trial.t.front();
    if (!with_attitude(trial) || !(length > 0.0)) continue;
    const auto frequency = [&](int half_cycles) { return 0.5 * half_cycles / length; };
    const LagSums sums = sums_of(rows(axis, with_attitude, [&](const Moment& at, Columns& row) {
      const double from_south = std::sin(heading(at)), from_east = std::cos(heading(at));
      for (int cycles = 1; cycles <= kHalfCycles; ++cycles) {
        const double phase =
            &at.trial == &trial ? 2.0 * std::numbers::pi * frequency(cycles) * (trial.t[at.k] - trial.t[0]) : kNaN;
        for (const double swings : {std::cos(phase), std::sin(phase)}) {
          row.push_back(swings * from_south);
          row.push_back(swings * from_east);
        }
      }
    }));
    for (int cycles = 1; cycles <= kHalfCycles; ++cycles) {
      const Eigen::Index first = kBaseColumns + 4 * (cycles - 1);
      Answer told = answer(sums, range(first, first + 4), kChosen);
      told.log_odds -= std::log(static_cast<double>(kHalfCycles) * static_cast<double>(runs_.size()));
      if (told.log_odds <= best.log_odds) continue;
      best.with =
          with_number("heading and time, like a force in the world that swings with %.2g Hz", frequency(cycles));
      best.share = told.share;
      best.log_odds = told.log_odds;
    }
  }
  return best;
}

Association LeftOver::oscillation(int axis) const {
  Association best{.axis = model::kAxisNames[static_cast<std::size_t>(axis)], .log_odds = -1.0};
  const std::vector<Eigen::MatrixXd> runs = rows(axis, always, [](const Moment&, Columns&) {});
  if (runs.empty()) return best;
  const LagSums sums = sums_of(runs);
  if (sums.samples() < kSamplesPerColumn * kBaseColumns) return best;
  const Eigen::MatrixXd products = sums.product(0, 0);
  const Eigen::VectorXd x = taken_up(products, range(0, kBaseColumns), products.col(kBaseColumns));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::vector<double> series;
    for (Eigen::Index k = 0; k < runs[r].rows(); ++k) {
      const double left = runs[r](k, kBaseColumns) - runs[r].row(k).head(kBaseColumns).dot(x);
      series.push_back(std::isfinite(left) ? left : 0.0);
    }
    const Line line = strongest_line(series, runs_[r].step);
    const double log_odds = line.log_odds - std::log(tried_ * static_cast<double>(runs.size()));
    if (log_odds <= best.log_odds) continue;
    best.with = with_number("an oscillation of %.2g Hz", line.frequency);
    best.share = line.share;
    best.log_odds = log_odds;
  }
  return best;
}

Association LeftOver::once(int axis, std::span<const std::vector<double>> left) const {
  const Episode told = episode(left);
  Association found{.axis = model::kAxisNames[static_cast<std::size_t>(axis)],
                    .share = told.share,
                    .log_odds = told.log_odds - std::log(tried_)};
  if (found.log_odds < 0.0) return found;
  const Run& run = runs_[told.run];
  const auto t = [&](std::size_t k) { return run.trial->t[run.at[k].k]; };
  found.with = with_number("an event from %.0f s", t(told.first)) + with_number(" to %.0f s", t(told.last) + run.step) +
               (runs_.size() > 1 ? " of " + run.trial->name : "");
  return found;
}

}  // namespace fathom::diagnosis
