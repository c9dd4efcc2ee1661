#include "common/planning/view.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/likelihood/hypothesis.hpp"

namespace fathom::planning {
namespace {

constexpr double kProbe = 0.25;  // of the time between inputs, to both sides, for the derivative

std::vector<Trial> one(const Trial& trial) { return {trial}; }

}  // namespace

View::View(const model::Vehicle& vehicle, const Trial& trial, double window)
    : View{vehicle, one(trial), model::nominal_model(vehicle, trial.input_is_wrench), trial.nu_sigma, window} {}

View::View(const model::Vehicle& vehicle, std::vector<Trial> trials, const model::Model& model, const Vector6d& sigma,
           double window)
    : trials_{std::move(trials)}, fit_{vehicle, trials_, {.window = window, .threads = 1}} {
  at_.model = model;
  at_.sigma = sigma;
  for (const auto& each : fit_.windows()) at_.nu0.push_back(each.window().trial->nu[each.window().start]);
  const std::vector<identification::ProjectedWindow> windows = fit_.linearise(at_);
  for (const auto& each : windows) rows_.push_back(each.jacobian.rows());
  const Eigen::Index all = std::accumulate(rows_.begin(), rows_.end(), Eigen::Index{0});
  jacobian_.resize(all, windows.front().jacobian.cols() + 1);
  Eigen::Index row = 0;
  for (const auto& each : windows) {
    jacobian_.block(row, 0, each.jacobian.rows(), each.jacobian.cols()) = each.jacobian;
    row += each.jacobian.rows();
    free_.push_back(each.initial_basis);
    weight_.push_back(each.weight);
  }
  without_ = residual(at_.model);
  jacobian_.rightCols<1>() = by_clock();
}

Eigen::VectorXd View::by_clock() const {
  const double step = trials_.front().input_step;
  if (!(step > 0.0)) return Eigen::VectorXd::Zero(jacobian_.rows());
  const likelihood::NumberSettings clock;
  const double sigma = (clock.offset_sigma + clock.offset_of_step * step) / step;  // of the time between inputs
  model::Model early = at_.model, late = at_.model;
  early.input_hold -= kProbe;
  late.input_hold += kProbe;
  return sigma / (2.0 * kProbe) * (residual(late) - residual(early));
}

Eigen::VectorXd View::residual(const model::Model& model) const {
  Eigen::VectorXd all(jacobian_.rows());
  model::VelocityTrace trace;
  Eigen::Index row = 0;
  for (std::size_t w = 0; w < rows_.size(); ++w) {
    Eigen::VectorXd of(rows_[w]);
    fit_.windows()[w].evaluate(model, at_.nu0[w], at_.sigma, trace, of);
    of.array() *= weight_[w].array();
    all.segment(row, rows_[w]) = of - free_[w] * (free_[w].transpose() * of);
    row += rows_[w];
  }
  return all;
}

Eigen::VectorXd View::change(const model::ActiveEffect& effect) const {
  model::Model with = at_.model;
  with.add(effect);
  return residual(with) - without_;
}

}  // namespace fathom::planning
