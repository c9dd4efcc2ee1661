#include "common/identification/input_hold.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/parallel.hpp"

namespace fathom::identification {
namespace {

constexpr double kLimit = 0.5;   // of the time between inputs: what is later is a delay of the vehicle
constexpr double kProbe = 0.25;  // to both sides, for the derivative
constexpr double kMoved = 0.05;  // less is not worth another fit
constexpr double kTold = 0.02;   // of the cost: beside a time after the command, less gain tells nothing of the hold
constexpr int kSteps = 3;

bool has_command_time(const model::Model& model) {
  return std::ranges::any_of(model.effects, [](const model::ActiveEffect& active) {
    return std::ranges::any_of(active.effect->parameters(), [](const auto& number) { return number.after_command; });
  });
}

/// What another hold must gain.
double least_gain(const FitResult& fit) { return has_command_time(fit.model) ? kTold * fit.cost : 0.0; }

}  // namespace

double input_hold(const TrajectoryFit& problem, const FitResult& fit) {
  model::Model early = fit.model, late = fit.model;
  early.input_hold -= kProbe;
  late.input_hold += kProbe;
  const std::vector<ProjectedWindow> windows = problem.linearise(fit);
  std::vector<Eigen::VectorXd> slope(windows.size());
  for_each_index(windows.size(), problem.settings().threads, [&](std::size_t w) {
    thread_local model::VelocityTrace trace;
    const WindowResidual& window = problem.windows()[w];
    Eigen::VectorXd before(window.rows()), after(window.rows());
    window.evaluate(early, fit.nu0[w], fit.sigma, trace, before);
    window.evaluate(late, fit.nu0[w], fit.sigma, trace, after);
    slope[w] = windows[w].weight.cwiseProduct(after - before) / (2.0 * kProbe);
    slope[w] -= windows[w].initial_basis * (windows[w].initial_basis.transpose() * slope[w]);
  });
  const ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& free = map[static_cast<std::size_t>(i)];
    information(i, i) = std::pow(free.scale / free.prior_sigma, 2);
  }
  Eigen::VectorXd shared = Eigen::VectorXd::Zero(n), gradient = Eigen::VectorXd::Zero(n);
  double curvature = 0.0, pull = 0.0;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    information += windows[w].jacobian.transpose() * windows[w].jacobian;
    shared += windows[w].jacobian.transpose() * slope[w];
    gradient += windows[w].jacobian.transpose() * windows[w].residual;
    curvature += slope[w].squaredNorm();
    pull += slope[w].dot(windows[w].residual);
  }
  const Eigen::VectorXd through = information.ldlt().solve(shared);
  curvature -= shared.dot(through);
  pull -= gradient.dot(through);
  if (!(curvature > 0.0) || !std::isfinite(pull)) return fit.model.input_hold;
  const double hold = std::clamp(fit.model.input_hold - pull / curvature, -kLimit, kLimit);
  const double moved = hold - fit.model.input_hold;
  return -moved * (pull + 0.5 * moved * curvature) > least_gain(fit) ? hold : fit.model.input_hold;
}

FitResult with_input_hold(const TrajectoryFit& problem, FitResult fit) {
  for (int step = 0; step < kSteps; ++step) {
    const double hold = input_hold(problem, fit);
    if (std::abs(hold - fit.model.input_hold) < kMoved) break;
    model::Model moved = fit.model;
    moved.input_hold = hold;
    FitResult better = problem.fit(moved, &fit);
    if (better.cost > fit.cost - least_gain(fit)) break;
    fit = std::move(better);
  }
  return fit;
}

}  // namespace fathom::identification
