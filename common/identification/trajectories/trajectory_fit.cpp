#include "common/identification/trajectories/trajectory_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "common/base/error.hpp"
#include "common/base/least_squares.hpp"
#include "common/base/parallel.hpp"
#include "common/identification/trajectories/fit_costs.hpp"
#include "common/identification/trajectories/outlier.hpp"
#include "common/identification/trajectories/pressed_bounds.hpp"

namespace fathom::identification {
namespace {

constexpr double kReleaseStep = 0.02;    // of a parameter's scale, away from its bound
constexpr double kTrimmedShare = 0.05;   // worst windows left out when the residual's scale is measured
constexpr double kSmallestSigma = 1e-5;  // m/s, rad/s: below any sensor's noise; keeps perfect data finite

bool all_at_bound(const ParameterMap& map, const std::vector<int>& numbers, const Eigen::VectorXd& x) {
  return std::ranges::all_of(numbers, [&](int i) { return map[static_cast<std::size_t>(i)].at_bound(x[i]); });
}

/// Those that are pressed go to their bounds; others that lie on one but want inside leave it, as far as the step says
/// or a little.
void put_on_bounds(const ParameterMap& map, const std::vector<int>& pressed, const Eigen::VectorXd& step,
                   Eigen::VectorXd& x) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (std::ranges::find(pressed, static_cast<int>(i)) != pressed.end()) {
      x[k] += step[k];
    } else if (map[i].at_bound(x[k])) {
      x[k] += std::clamp(step[k], -kReleaseStep, kReleaseStep);
    }
  }
}

/// "RUN is 12 s long, its pose valid for 40 %, its velocity for 98 %; ..."
std::string valid_shares(std::span<const Trial> trials) {
  std::string text;
  for (const Trial& trial : trials) {
    const auto size = static_cast<double>(trial.size());
    text += (text.empty() ? "" : "; ") + trial.name + " is " + std::to_string(std::lround(size * trial.dt)) + " s long";
    const auto share = [&](bool observed, const char* group, const std::vector<std::uint8_t>& valid) {
      if (!observed || trial.size() == 0) return;
      const auto count = static_cast<double>(valid.size()) - static_cast<double>(std::ranges::count(valid, 0));
      text += std::string(", its ") + group + " valid for " + std::to_string(std::lround(100.0 * count / size)) + " %";
    };
    share(trial.observed.position || trial.observed.attitude, "pose", trial.pose_valid);
    share(trial.observed.velocity, "velocity", trial.velocity_valid);
    share(trial.observed.rates, "rates", trial.rates_valid);
  }
  return text;
}

}  // namespace

TrajectoryFit::TrajectoryFit(const model::Vehicle& vehicle, std::span<const Trial> trials, const FitSettings& settings)
    : vehicle_{vehicle}, settings_{settings} {
  const std::vector<model::Window> cut = cut_windows(trials, settings.window);
  const std::size_t stride = std::max<std::size_t>(1, (cut.size() + settings.most_windows - 1) / settings.most_windows);
  for (std::size_t w = 0; w < cut.size(); w += stride) {
    WindowResidual residual{cut[w], vehicle};
    if (residual.rows() > 0) windows_.push_back(std::move(residual));
  }
  if (windows_.empty()) {
    throw InputError("no stretch of " + std::to_string(std::lround(settings.window)) +
                     " s in which all that was measured is valid: " + valid_shares(trials) +
                     "; record longer, or see fathom check for what is not believed");
  }
}

Vector6d TrajectoryFit::residual_scale(const FitResult& fit) const {
  Vector6d sigma = fit.sigma;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    std::vector<std::pair<double, double>> windows;  // mean square, count
    for (std::size_t w = 0; w < windows_.size(); ++w) {
      if (fit.window_count[w][axis] > 0.0) {
        windows.emplace_back(fit.window_square[w][axis] / fit.window_count[w][axis], fit.window_count[w][axis]);
      }
    }
    if (windows.empty()) continue;
    std::sort(windows.begin(), windows.end());
    const auto kept = std::max<std::size_t>(
        1, windows.size() - static_cast<std::size_t>(kTrimmedShare * static_cast<double>(windows.size())));
    double square = 0.0, count = 0.0;
    for (std::size_t i = 0; i < kept; ++i) {
      square += windows[i].first * windows[i].second;
      count += windows[i].second;
    }
    sigma[static_cast<Eigen::Index>(axis)] = std::max(std::sqrt(square / count), kSmallestSigma);
  }
  return sigma;
}

void TrajectoryFit::score(FitResult& fit) const {
  fit.window_cost.assign(windows_.size(), 0.0);
  fit.window_square.assign(windows_.size(), {});
  fit.window_count.assign(windows_.size(), {});
  for_each_index(windows_.size(), settings_.threads, [&](std::size_t w) {
    thread_local model::VelocityTrace trace;
    const WindowResidual& window = windows_[w];
    Eigen::VectorXd residual(window.rows());
    window.evaluate(fit.model, fit.nu0[w], fit.sigma, trace, residual);
    fit.window_cost[w] = robust_cost(residual, window.axes());
    for (Eigen::Index i = 0; i < residual.size(); ++i) {
      const int axis = window.axis(i);
      const double error = residual[i] * fit.sigma[axis];
      fit.window_square[w][static_cast<std::size_t>(axis)] += error * error;
      fit.window_count[w][static_cast<std::size_t>(axis)] += 1.0;
    }
  });
  fit.cost = std::accumulate(fit.window_cost.begin(), fit.window_cost.end(), 0.0);
}

double TrajectoryFit::cost(const model::Model& model, const FitResult& like) const {
  FitResult fit;
  fit.model = model;
  fit.sigma = like.sigma;
  fit.nu0 = like.nu0;
  score(fit);
  return fit.cost;
}

void TrajectoryFit::solve(FitResult& fit, double tolerance) const {
  const ParameterMap map{fit.model};
  const model::Model shape = fit.model;
  Eigen::VectorXd x = map.pack(fit.model);
  Evaluations evaluations{windows_, shape, map, fit.sigma, x, fit.nu0, settings_.threads};
  ceres::Problem::Options shared;
  shared.evaluation_callback = &evaluations;
  ceres::Problem problem{shared};
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  problem.AddParameterBlock(x.data(), static_cast<int>(x.size()));
  ordering->AddElementToGroup(x.data(), 1);
  problem.AddResidualBlock(new PriorCost(map), nullptr, x.data());
  std::vector<int> unsimulated;
  for (int axis = 0; axis < 6; ++axis) {
    if (!vehicle_.dof[static_cast<std::size_t>(axis)]) unsimulated.push_back(axis);
  }
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    for (const AxisRows& rows : windows_[w].axes()) {
      problem.AddResidualBlock(new AxisCost(evaluations, w, rows, map.size()),
                               new ceres::HuberLoss(outlier_bound(rows.count)), x.data(), fit.nu0[w].data());
    }
    ordering->AddElementToGroup(fit.nu0[w].data(), 0);
    if (!unsimulated.empty()) problem.SetManifold(fit.nu0[w].data(), new ceres::SubsetManifold(6, unsimulated));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.linear_solver_ordering = ordering;
  options.num_threads = 1;
  options.max_num_iterations = settings_.iterations;
  options.function_tolerance = tolerance > 0.0 ? tolerance : settings_.tolerance;
  options.logging_type = ceres::SILENT;

  constexpr int kPasses = 5;
  std::vector<int> held;
  double last_cost = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < kPasses; ++pass) {
    double cost = 0.0;
    evaluations.PrepareForEvaluation(true, true);
    problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
    const double little = options.function_tolerance * cost;
    const BoundedStep step = bounded_step(evaluations, windows_, map, x, settings_.threads);
    std::vector<int> pressed = pressed_numbers(map, x, step);
    const bool arrived = step.foretold < little && all_at_bound(map, pressed, x);
    if (pass > 0 && (arrived || (pressed == held && last_cost - cost < little))) break;
    held = std::move(pressed);
    last_cost = cost;
    const Eigen::VectorXd last_x = x;
    const std::vector<Vector6d> last_nu0 = fit.nu0;
    put_on_bounds(map, held, step.d, x);
    problem.SetManifold(x.data(), new InsideBounds(map, held));
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    fit.converged = summary.termination_type == ceres::CONVERGENCE;
    if (summary.final_cost > cost) {
      x = last_x;
      fit.nu0 = last_nu0;
      break;
    }
  }
  map.unpack(x, fit.model);
}

FitResult TrajectoryFit::fit(const model::Model& start, const FitResult* like, double tolerance) const {
  FitResult fit;
  fit.model = start;
  if (like != nullptr) {
    fit.sigma = like->sigma;
    fit.nu0 = like->nu0;
    solve(fit, tolerance);
    score(fit);
    return fit;
  }
  for (const WindowResidual& window : windows_) fit.nu0.push_back(window.window().trial->nu[window.window().start]);
  score(fit);
  for (int round = 0; round < settings_.weight_rounds; ++round) {
    fit.sigma = residual_scale(fit);
    solve(fit, tolerance);
    score(fit);
  }
  fit.sigma = residual_scale(fit);
  score(fit);
  return fit;
}

std::vector<ProjectedWindow> TrajectoryFit::linearise(const FitResult& fit) const {
  const ParameterMap map{fit.model};
  std::vector<ProjectedWindow> projected(windows_.size());
  for_each_index(windows_.size(), settings_.threads, [&](std::size_t w) {
    thread_local model::VelocityTrace trace;
    const WindowResidual& window = windows_[w];
    ProjectedWindow& out = projected[w];
    out.residual.resize(window.rows());
    window.evaluate(fit.model, fit.nu0[w], fit.sigma, trace, out.residual);
    Eigen::MatrixXd initial;
    window.jacobians(fit.model, map, fit.nu0[w], fit.sigma, out.residual, out.jacobian, initial);
    out.weight = robust_weight(out.residual, window.axes());
    out.residual.array() *= out.weight.array();
    out.jacobian.array().colwise() *= out.weight.array();
    initial.array().colwise() *= out.weight.array();
    out.initial_basis = range_basis(initial);
    out.residual -= out.initial_basis * (out.initial_basis.transpose() * out.residual);
    out.jacobian -= out.initial_basis * (out.initial_basis.transpose() * out.jacobian);
  });
  return projected;
}

}  // namespace fathom::identification
