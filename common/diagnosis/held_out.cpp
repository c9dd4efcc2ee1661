#include "common/diagnosis/held_out.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/statistics.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr int kFolds = 5;
constexpr std::size_t kFoldBlock = 3;  // windows that stay together, so that held-out data is not a neighbour's echo
constexpr std::size_t kFewestRuns = 3;
constexpr double kApart = 1.5;  // times the base model's square error: then blocks do not tell of each other

std::vector<int> folds_by_block(std::size_t windows) {
  std::vector<int> folds(windows);
  for (std::size_t w = 0; w < windows; ++w) folds[w] = static_cast<int>((w / kFoldBlock) % kFolds);
  return folds;
}

/// Empty with too few runs.
std::vector<int> folds_by_run(std::span<const identification::WindowResidual> windows) {
  std::vector<int> folds;
  std::vector<const Trial*> runs;
  for (const auto& window : windows) {
    const Trial* run = window.window().trial;
    const auto place = std::ranges::find_if(runs, [&](const Trial* one) { return same_run(*one, *run); });
    folds.push_back(static_cast<int>(place - runs.begin()));
    if (place == runs.end()) runs.push_back(run);
  }
  if (runs.size() < kFewestRuns) folds.clear();
  return folds;
}

int fold_count(std::span<const int> folds) {
  return folds.empty() ? 0 : *std::max_element(folds.begin(), folds.end()) + 1;
}

}  // namespace

bool keeps_its_value(const identification::FreeParameter& number, const model::Model& model) {
  if (number.effect < 0) return false;
  const int amplitudes = model.effects[static_cast<std::size_t>(number.effect)].effect->amplitudes();
  return amplitudes > 0 && number.component >= amplitudes;
}

void CrossValidation::Window::operator+=(const Window& other) {
  information += other.information;
  gradient += other.gradient;
  square += other.square;
}

double CrossValidation::Window::after(const Eigen::VectorXd& step) const {
  return std::max(square + 2.0 * step.dot(gradient) + step.dot(information * step), 0.0);
}

CrossValidation::CrossValidation(const TrajectoryFit& problem, const FitResult& fit) {
  const identification::ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  const Eigen::VectorXd x = map.pack(fit.model);
  all_ = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (identification::ProjectedWindow& window : problem.linearise(fit)) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (keeps_its_value(map[static_cast<std::size_t>(i)], fit.model)) window.jacobian.col(i).setZero();
    }
    windows_.push_back({window.jacobian.transpose() * window.jacobian, window.jacobian.transpose() * window.residual,
                        window.residual.squaredNorm()});
    all_ += windows_.back();
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    // Correlated residuals overstate the information by this factor; against the prior it must not count.
    double scatter = 0.0;
    for (const Window& window : windows_) scatter += window.gradient[i] * window.gradient[i];
    const double information = all_.information(i, i);
    const double inflation = information > 0.0 ? std::max(1.0, scatter / information) : 1.0;
    const auto& free = map[static_cast<std::size_t>(i)];
    const double prior = inflation * std::pow(free.scale / free.prior_sigma, 2);
    all_.information(i, i) += prior;
    if (!keeps_its_value(free, fit.model)) all_.gradient[i] += prior * (x[i] - free.prior_mean / free.scale);
  }
}

CrossValidation::Window CrossValidation::sum(std::span<const int> folds, int fold) const {
  const Eigen::Index n = all_.gradient.size();
  Window out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    if (folds[w] == fold) out += windows_[w];
  }
  return out;
}

double CrossValidation::error() const { return all_.square; }

double CrossValidation::error(std::span<const int> folds) const {
  double error = 0.0;
  for (int fold = 0; fold < fold_count(folds); ++fold) {
    const Window out = sum(folds, fold);
    // One Gauss-Newton step from the fit of all data to the fit of the other folds.
    error += out.after(-(all_.information - out.information).ldlt().solve(all_.gradient - out.gradient));
  }
  return error;
}

double CrossValidation::error(std::span<const int> folds, std::span<const Eigen::Index> places) const {
  const Eigen::Index n = all_.gradient.size();
  std::vector<Eigen::Index> rest;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::find(places.begin(), places.end(), i) == places.end()) rest.push_back(i);
  }
  const Eigen::MatrixXd rest_information = all_.information(rest, rest);
  const Eigen::LDLT<Eigen::MatrixXd> solver{rest_information};
  const Eigen::MatrixXd answer = solver.solve(Eigen::MatrixXd(all_.information(rest, places)));
  double error = 0.0;
  for (int fold = 0; fold < fold_count(folds); ++fold) {
    const Window out = sum(folds, fold);
    const Eigen::VectorXd others = -(all_.information - out.information).ldlt().solve(all_.gradient - out.gradient);
    Eigen::VectorXd step(n);
    step(places) = others(places);
    step(rest) = -answer * others(places);
    error += out.after(step);
  }
  return error;
}

double error_left_out(const TrajectoryFit& problem, const FitResult& fit) {
  return CrossValidation{problem, fit}.error(folds_by_block(problem.windows().size()));
}

HeldOut held_out(const TrajectoryFit& problem, const CrossValidation& without, const CrossValidation& with,
                 std::span<const Eigen::Index> places) {
  const auto saved = [](double before, double after) { return before > 0.0 ? 1.0 - std::sqrt(after / before) : 0.0; };
  const std::vector<int> blocks = folds_by_block(problem.windows().size());
  const std::vector<int> runs = folds_by_run(problem.windows());
  // Where axes are excited one after the other, what a block needs of the base model is in no other block.
  const bool apart = without.error(blocks) > kApart * without.error();
  const double by_block =
      apart ? saved(without.error(), with.error(blocks, places)) : saved(without.error(blocks), with.error(blocks));
  return {by_block, runs.empty() ? by_block : saved(without.error(), with.error(runs, places))};
}

double prediction_change(const TrajectoryFit& problem, const FitResult& without, const FitResult& with) {
  model::VelocityTrace trace;
  std::array<double, 6> moved_square{}, measured_square{};
  for (std::size_t w = 0; w < problem.windows().size(); ++w) {
    const auto& window = problem.windows()[w];
    Eigen::VectorXd before(window.rows()), after(window.rows());
    window.evaluate(without.model, without.nu0[w], without.sigma, trace, before);
    window.evaluate(with.model, with.nu0[w], without.sigma, trace, after);
    for (Eigen::Index i = 0; i < before.size(); ++i) {
      const auto axis = static_cast<std::size_t>(window.axis(i));
      moved_square[axis] += std::pow(without.sigma[window.axis(i)] * (after[i] - before[i]), 2);
      measured_square[axis] += window.measured(i) * window.measured(i);
    }
  }
  double change = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (measured_square[axis] > 0.0) change = std::max(change, std::sqrt(moved_square[axis] / measured_square[axis]));
  }
  return change;
}

}  // namespace fathom::diagnosis
