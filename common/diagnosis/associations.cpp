#include "common/diagnosis/associations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/diagnosis/bursts.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/diagnosis/product_sums.hpp"
#include "common/identification/lag_sums.hpp"
#include "common/residual/force_residual.hpp"
#include "common/residual/prediction.hpp"

namespace fathom::diagnosis {
namespace {

using identification::ColouredFit;
using identification::LagSums;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Questions besides the suspects: thrusters, a step, a swing, an oscillation, bursts, an event.
constexpr std::size_t kBesides = 6;

/// m/s, rad/s: what is ordinary in these runs (RMS).
Vector6d ordinary_speeds(std::span<const Trial> trials) {
  Vector6d sum = Vector6d::Zero();
  double samples = 0.0;
  for (const Trial& trial : trials) {
    for (const Vector6d& nu : trial.nu) {
      sum += nu.array().isFinite().select(nu.cwiseAbs2(), 0.0);
      samples += 1.0;
    }
  }
  return samples > 0.0 ? Vector6d{(sum / samples).cwiseSqrt()} : sum;
}

}  // namespace

LeftOver::LeftOver(const model::Model& model, std::span<const Trial> trials,
                   std::span<const std::vector<Vector6d>> residuals)
    : model_{model} {
  const Vector6d ordinary = ordinary_speeds(trials);
  for (std::size_t r = 0; r < trials.size(); ++r) {
    const Trial& trial = trials[r];
    const std::size_t span = residual_span(trial.dt);
    const auto nu = predict_anew(model, trial, restarts(trial));
    Run run{.trial = &trial, .step = static_cast<double>(span) * trial.dt};
    const Vector6d unknown = Vector6d::Constant(kNaN);
    for (std::size_t k = span / 2; k < trial.size(); k += span) {
      // What comes within the span may answer to the noise that is in the residual: asked is what there was before it.
      const std::size_t before = k - span / 2;
      Moment at{.trial = trial, .k = before, .tau = {model.allocation * trial.input[before], unknown, unknown}};
      for (std::size_t ago = 1; ago < at.tau.size() && ago <= run.at.size(); ++ago)
        at.tau[ago] = run.at[run.at.size() - ago].tau[0];
      for (std::size_t axis = 0; axis < 6; ++axis)
        at.nu[static_cast<Eigen::Index>(axis)] = model.vehicle->dof[axis] ? nu[before][axis] : 0.0;
      at.dof = model.vehicle->dof;
      at.nu_rms = ordinary;
      run.at.push_back(at);
      run.wrench.push_back(residuals[r][k]);
    }
    if (!run.at.empty()) runs_.push_back(std::move(run));
  }
  const auto axes = static_cast<double>(std::ranges::count(model.vehicle->dof, true));
  tried_ = axes * static_cast<double>(suspects().size() + kBesides);
}

std::vector<Eigen::MatrixXd> LeftOver::rows(int axis, bool (*seen)(const Trial&), const Asked& asked) const {
  std::vector<Eigen::MatrixXd> all;
  Columns row;
  for (const Run& run : runs_) {
    if (!seen(*run.trial)) continue;
    Eigen::MatrixXd& of = all.emplace_back();
    for (std::size_t i = 0; i < run.at.size(); ++i) {
      row.clear();
      base_columns(run.at[i], axis, row);
      asked(run.at[i], row);
      row.push_back(run.wrench[i][axis]);
      if (i == 0) of.resize(static_cast<Eigen::Index>(run.at.size()), static_cast<Eigen::Index>(row.size()));
      of.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), of.cols());
    }
  }
  standardise(all);
  return all;
}

LeftOver::Answer LeftOver::answer(const LagSums& sums, const Indices& asked, double hidden) const {
  const Eigen::Index target = sums.columns() - 1;
  const Indices base = range(0, kBaseColumns);
  Indices both = base;
  both.insert(both.end(), asked.begin(), asked.end());
  const double n = sums.samples();
  if (n < kSamplesPerColumn * static_cast<double>(both.size())) return {};
  const ColouredFit without = identification::fit_coloured(sums, base, target);
  const ColouredFit with = identification::fit_coloured(sums, both, target);
  if (with.rank <= without.rank || !(with.sse > 0.0) || !(without.sse > 0.0)) return {};
  const double price = 0.5 * (with.rank - without.rank + hidden) * std::log(n) + std::log(tried_);
  const Eigen::MatrixXd products = sums.product(0, 0);
  const double before = square_left(products, base, {}, {});
  const double after = square_left(products, base, asked, with.x.tail(static_cast<Eigen::Index>(asked.size())));
  const double of_variance = before > 0.0 ? 1.0 - after / before : 0.0;
  // Few samples beside many columns: what the base columns and the memory take up is no evidence (Liang et al. 2008,
  // eq. 6, the unit information prior).
  const double free = n - without.rank - static_cast<double>(LagSums::kMemory);
  return {std::max(of_variance, 1.0 - with.sse / without.sse), 0.5 * free * std::log(without.sse / with.sse) - price};
}

LeftOver::Answer LeftOver::answer(int axis, bool (*seen)(const Trial&), const Asked& asked) const {
  const std::vector<Eigen::MatrixXd> runs = rows(axis, seen, asked);
  if (runs.empty() || runs.front().cols() == kBaseColumns + 1) return {};
  return answer(sums_of(runs), range(kBaseColumns, runs.front().cols() - 1), 0.0);
}

std::vector<Association> LeftOver::of_suspects(int axis) const {
  std::vector<Association> found;
  for (const Suspect& suspect : suspects()) {
    const Answer told =
        answer(axis, suspect.seen, [&](const Moment& at, Columns& row) { suspect.columns(at, axis, row); });
    found.push_back({model::kAxisNames[static_cast<std::size_t>(axis)], suspect.name, told.share, told.log_odds});
  }
  return found;
}

std::vector<std::vector<double>> LeftOver::unforetold_along(int axis) const {
  const auto& dof = model_.vehicle->dof;
  if (axis >= 3 && (dof[0] || dof[1] || dof[2])) return {};
  const std::vector<Eigen::MatrixXd> runs = rows(axis, always, [](const Moment&, Columns&) {});
  if (runs.empty()) return {};
  const LagSums sums = sums_of(runs);
  if (sums.samples() < kSamplesPerColumn * kBaseColumns) return {};
  const ColouredFit fit = identification::fit_coloured(sums, range(0, kBaseColumns), kBaseColumns);
  std::vector<Eigen::VectorXd> all;
  all.reserve(runs.size());
  for (const Eigen::MatrixXd& run : runs) all.emplace_back(run.col(kBaseColumns) - run.leftCols(kBaseColumns) * fit.x);
  return unforetold(all);
}

Association LeftOver::in_bursts(int axis, std::span<const std::vector<double>> left) const {
  const Bursts told = bursts(left);
  Association found{.axis = model::kAxisNames[static_cast<std::size_t>(axis)],
                    .with = "bursts of no recorded cause",
                    .share = told.share,
                    .log_odds = told.log_odds - std::log(tried_)};
  if (found.log_odds < 0.0) return found;
  double best = 0.0;
  for (const Circumstance& one : circumstances()) {
    std::vector<std::vector<double>> quantity;
    for (const Run& run : runs_) {
      std::vector<double>& of_run = quantity.emplace_back();
      for (const Moment& at : run.at) of_run.push_back(one.seen(at.trial) ? one.of(at, axis) : kNaN);
    }
    const double log_odds = size_goes_with(left, quantity) - std::log(static_cast<double>(circumstances().size()));
    if (log_odds <= best) continue;
    best = log_odds;
    found.with = std::string("bursts, whose size goes with ") + one.name;
  }
  return found;
}

double LeftOver::size(int axis) const {
  struct Spread {
    double sum{}, square{}, count{};
    void add(double x) { sum += x, square += x * x, count += 1.0; }
    [[nodiscard]] double variance() const { return square / count - sum / count * (sum / count); }
  } left, applied;
  for (const Run& run : runs_) {
    for (std::size_t i = 0; i < run.at.size(); ++i) {
      const double residual = run.wrench[i][axis], tau = run.at[i].tau[0][axis];
      if (!std::isfinite(residual)) continue;
      left.add(residual);
      applied.add(tau);
    }
  }
  if (left.count < 2.0 || !(applied.variance() > 0.0)) return kNaN;
  return std::sqrt(left.variance() / applied.variance());
}

std::vector<Association> LeftOver::associations(double share, double log_odds, double of_wrench) const {
  std::vector<Association> found;
  for (int axis = 0; axis < 6; ++axis) {
    if (!model_.vehicle->dof[static_cast<std::size_t>(axis)]) continue;
    std::vector<Association> of_axis = of_suspects(axis);
    of_axis.push_back(of_thrusters(axis));
    of_axis.push_back(step(axis));
    of_axis.push_back(swing(axis));
    of_axis.push_back(oscillation(axis));
    const std::vector<std::vector<double>> unforetold = unforetold_along(axis);
    of_axis.push_back(in_bursts(axis, unforetold));
    of_axis.push_back(once(axis, unforetold));
    const double whole = size(axis);
    for (Association& one : of_axis) one.of_wrench = std::sqrt(one.share) * whole;
    std::erase_if(of_axis, [&](const Association& a) {
      return !(a.share >= share && a.log_odds >= log_odds) || a.of_wrench < of_wrench;
    });
    found.insert(found.end(), of_axis.begin(), of_axis.end());
  }
  std::ranges::stable_sort(found, std::greater{}, &Association::share);
  return found;
}

double LeftOver::log_odds(const FreeCurve& curve) const {
  return answer(curve.axis(), always,
                [&](const Moment& at, Columns& row) {
                  model::Motion motion{.t = at.trial.t[at.k],
                                       .p_WB = at.trial.p_WB[at.k],
                                       .R_WB = at.trial.q_WB[at.k].toRotationMatrix(),
                                       .nu = at.nu};
                  motion.force = at.trial.input[at.k];
                  motion.vehicle = model_.vehicle;
                  std::array<double, FreeCurve::kKnots> knots{};
                  for (std::size_t i = 0; i < knots.size(); ++i) {
                    knots.fill(0.0);
                    knots[i] = 1.0;
                    model::Load load;
                    curve.load(motion, knots, 0, load);
                    row.push_back(load.wrench[curve.axis()]);
                  }
                })
      .log_odds;
}

}  // namespace fathom::diagnosis
