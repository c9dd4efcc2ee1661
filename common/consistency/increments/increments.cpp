#include "common/consistency/increments/increments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/statistics.hpp"
#include "common/consistency/increments/increment_estimate.hpp"
#include "common/consistency/increments/increment_normals.hpp"

namespace fathom::consistency {
namespace {

constexpr int kMatrix = 9;            // columns of M
constexpr double kCoarseStep = 0.05;  // s: well under a quarter period of 2 Hz
constexpr double kFineStep = 0.02;    // s: the cost is a parabola over this
constexpr double kOutlier = 8.0;      // robust sigmas; 6 would flag a clean hour of data
constexpr std::size_t kFewestWindows = 60;
constexpr double kSharp = 0.8;          // least over median cost of all delays
constexpr double kUsualDelay = 0.1;     // s, one sigma of a delay that these data do not show
constexpr double kLeverSeen = 30.0;     // energy of a lever column over its noise: the bias stays under 5 mm
constexpr double kBlockSeconds = 30.0;  // longer than any closed loop remembers

/// One delay: a design row triple per window.
class Design {
 public:
  Design(const IncrementProblem& problem, int fixed_columns) : problem_(problem), fixed_columns_(fixed_columns) {
    values_.resize(problem.t.size());
    valid_.resize(problem.t.size());
  }
  /// Every `stride`-th window is made ready.
  void shift(const Spline& sensor, double delay, std::size_t stride = 1) {
    for (std::size_t i = 0; i < values_.size(); ++i) valid_[i] = sensor.at(problem_.t[i] + delay, values_[i]);
    rows_.resize(problem_.windows.size());
    whole_.assign(problem_.windows.size(), false);
    for (std::size_t i = 0; i < rows_.size(); i += stride) whole_[i] = build(i, rows_[i]);
  }
  /// False when the sensor is missing somewhere in the window.
  bool rows(std::size_t window, Rows& rows) const {
    if (whole_[window]) rows = rows_[window];
    return whole_[window];
  }

 private:
  bool build(std::size_t window, Rows& rows) const {
    const IncrementProblem::Window& w = problem_.windows[window];
    rows.resize(3, kMatrix + fixed_columns_);
    // M's columns stand one behind the other, as a basis does: in memory the nine columns are basis times value.
    Eigen::Matrix<double, 9, 3> sum = Eigen::Matrix<double, 9, 3>::Zero();
    for (int s = 0; s < w.count; ++s) {
      const auto i = static_cast<std::size_t>(w.first + s);
      if (!valid_[i]) return false;
      const double* basis = problem_.basis[static_cast<std::size_t>(w.basis + s)].data();
      sum.noalias() += Eigen::Map<const Eigen::Matrix<double, 9, 1>>(basis) * values_[i].transpose();
    }
    rows.leftCols<kMatrix>() = Eigen::Map<const Eigen::Matrix<double, 3, kMatrix>>(sum.data());
    rows.rightCols(fixed_columns_) = problem_.fixed[window].leftCols(fixed_columns_);
    return true;
  }

  const IncrementProblem& problem_;
  int fixed_columns_;
  std::vector<Eigen::Vector3d> values_;
  std::vector<bool> valid_;
  std::vector<Rows> rows_;
  std::vector<bool> whole_;
};

/// Misfits per window (NaN where the sensor is missing) for theta, and Huber weights from them.
struct Misfits {
  std::vector<Eigen::Vector3d> error;
  Eigen::Vector3d sigma{Eigen::Vector3d::Zero()};
  double typical{};
  [[nodiscard]] double weight(std::size_t window) const {
    if (std::isnan(error[window].x())) return 0.0;
    const double ratio = error[window].norm() / typical;
    return ratio > 6.0 ? 0.0 : huber_weight(ratio, 2.5);  // norm of three: 2.5 is ordinary
  }
};

Misfits misfits(const IncrementProblem& problem, const Design& design, const Eigen::VectorXd& theta,
                std::size_t stride) {
  Misfits result;
  result.error.assign(problem.windows.size(), Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  std::array<std::vector<double>, 3> parts;
  Rows rows;
  for (std::size_t i = 0; i < problem.windows.size(); i += stride) {
    if (!design.rows(i, rows)) continue;
    result.error[i] = problem.y[i] - rows * theta;
    for (std::size_t k = 0; k < 3; ++k) parts[k].push_back(result.error[i][static_cast<int>(k)]);
  }
  for (std::size_t k = 0; k < 3; ++k) result.sigma[static_cast<int>(k)] = mad_sigma(std::move(parts[k]));
  result.typical = std::max(result.sigma.norm() / std::sqrt(3.0), 1e-12);
  return result;
}

/// Sums for R^2. An outlier counts with six sigmas: forgotten, it would let a wrong model choose the data it explains.
void add_explained(const Misfits& misfit, std::size_t window, const Eigen::Vector3d& y, double& squares,
                   double& total) {
  const double cap = std::pow(6.0 * misfit.typical, 2);
  const double square = misfit.error[window].squaredNorm();
  squares += std::min(square, cap);
  total += square < cap ? y.squaredNorm() : cap;
}

struct Coarse {
  double cost{std::numeric_limits<double>::infinity()};
  double explained{};
  Eigen::VectorXd theta;
};

/// Least squares and one robust pass; cost is the mean absolute misfit over the size of y.
Coarse coarse_fit(const IncrementProblem& problem, const Design& design, int fixed_columns, std::size_t stride) {
  Coarse result;
  Rows rows;
  Normals normals(kMatrix + fixed_columns);
  std::size_t used = 0;
  for (std::size_t i = 0; i < problem.windows.size(); i += stride) {
    if (!design.rows(i, rows)) continue;
    normals.add(rows, problem.y[i], 1.0);
    ++used;
  }
  if (used * stride < kFewestWindows) return result;
  result.theta = normals.solve();
  Misfits misfit = misfits(problem, design, result.theta, stride);
  Normals robust(kMatrix + fixed_columns);
  for (std::size_t i = 0; i < problem.windows.size(); i += stride) {
    const double weight = misfit.weight(i);
    if (weight > 0.0 && design.rows(i, rows)) robust.add(rows, problem.y[i], weight);
  }
  result.theta = robust.solve();
  misfit = misfits(problem, design, result.theta, stride);
  double sum = 0.0, squares = 0.0, total = 0.0, count = 0.0;
  for (std::size_t i = 0; i < problem.windows.size(); i += stride) {
    if (std::isnan(misfit.error[i].x())) continue;
    sum += std::min(misfit.error[i].norm(), 6.0 * misfit.typical);
    add_explained(misfit, i, problem.y[i], squares, total);
    count += 1.0;
  }
  result.cost = sum / count;
  result.explained = total > 0.0 ? 1.0 - squares / total : 0.0;
  return result;
}

struct Vertex {
  double offset{};  ///< in steps
  bool inside{false};
};
Vertex parabola(double left, double middle, double right) {
  const double bend = left - 2.0 * middle + right;
  if (!(bend > 0.0)) return {};
  const double offset = 0.5 * (left - right) / bend;
  return {offset, std::abs(offset) <= 1.0};
}
template <class T>
T through(const T& left, const T& middle, const T& right, double offset) {
  return middle + 0.5 * offset * (right - left) + 0.5 * offset * offset * (right - 2.0 * middle + left);
}

}  // namespace

std::vector<double> quadrature_weights(const double* t, int count) {
  std::vector<double> weight(static_cast<std::size_t>(count), 0.0);
  for (int i = 1; i < count; ++i) {
    const double half = 0.5 * (t[i] - t[i - 1]);
    weight[static_cast<std::size_t>(i - 1)] += half;
    weight[static_cast<std::size_t>(i)] += half;
  }
  // Euler-Maclaurin: minus h^2/12 (f'(b) - f'(a)), slopes from three points each.
  const double h = (t[count - 1] - t[0]) / (count - 1);
  const auto last = static_cast<std::size_t>(count - 1);
  const double c = h / 24.0;
  weight[0] -= 3.0 * c;
  weight[1] += 4.0 * c;
  weight[2] -= c;
  weight[last] -= 3.0 * c;
  weight[last - 1] += 4.0 * c;
  weight[last - 2] -= c;
  return weight;
}

IncrementFit fit_increments(const IncrementProblem& problem, const Series& sensor, const IncrementOptions& options) {
  IncrementFit fit;
  if (problem.windows.size() < kFewestWindows || sensor.size() < kFewestWindows) {
    fit.why_not = "too little common data";
    return fit;
  }
  const Spline spline(sensor);
  // Coarse search with biases only (the first three fixed columns), on a third of the windows.
  const int bias_columns = std::min(3, problem.fixed_columns);
  Design coarse_design(problem, bias_columns);
  const std::size_t stride = problem.windows.size() > 900 ? 3 : 1;
  double delay = 0.0;
  Coarse best;
  std::vector<double> costs;
  const int reach = options.search_delay ? static_cast<int>(std::ceil(options.longest_delay / kCoarseStep)) : 0;
  for (int step = -reach; step <= reach; ++step) {
    coarse_design.shift(spline, step * kCoarseStep, stride);
    const Coarse trial = coarse_fit(problem, coarse_design, bias_columns, stride);
    if (std::isfinite(trial.cost)) costs.push_back(trial.cost);
    if (trial.cost < best.cost) {
      best = trial;
      delay = step * kCoarseStep;
    }
  }
  if (!std::isfinite(best.cost)) {
    fit.why_not = "too little common data";
    return fit;
  }
  fit.delay = delay;
  fit.theta = best.theta;
  fit.explained = best.explained;
  fit.delay_found = std::abs(delay) < options.longest_delay - kCoarseStep;
  fit.ok = true;
  if (options.quick) return fit;

  // Fine search: weights frozen at the best delay, blocks of normal equations at three delays.
  const int columns = kMatrix + problem.fixed_columns;
  Design middle(problem, problem.fixed_columns);
  const double span = problem.t.back() - problem.t.front();
  const int blocks = std::clamp(static_cast<int>(span / kBlockSeconds), 8, 20);
  std::vector<double> weights(problem.windows.size(), 0.0);
  std::array<std::vector<Normals>, 3> normals;
  Vertex vertex;
  Rows rows;
  const auto look = [&](bool weighed) {
    middle.shift(spline, delay);
    Normals all(columns);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double weight = weighed ? weights[i] : 1.0;
      if (weight > 0.0 && middle.rows(i, rows)) all.add(rows, problem.y[i], weight);
    }
    fit.theta = all.solve();
    const Misfits misfit = misfits(problem, middle, fit.theta, 1);
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = misfit.weight(i);
    fit.residual = misfit.sigma;
    for (int node = 0; node < 3; ++node) {
      auto& list = normals[static_cast<std::size_t>(node)];
      list.assign(static_cast<std::size_t>(blocks), Normals(columns));
      Design design(problem, problem.fixed_columns);
      design.shift(spline, delay + (node - 1) * kFineStep);
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (weights[i] <= 0.0 || !design.rows(i, rows)) continue;
        const auto block = i * static_cast<std::size_t>(blocks) / weights.size();
        list[block].add(rows, problem.y[i], weights[i]);
      }
    }
  };
  for (int round = 0; round < 5; ++round) {
    look(round > 0);
    std::array<double, 3> cost{};
    for (std::size_t node = 0; node < 3; ++node) {
      Normals sum(columns);
      for (const Normals& block : normals[node]) sum.add(block, 1.0);
      cost[node] = sum.cost(sum.solve());
    }
    if (!options.search_delay) break;
    vertex = parabola(cost[0], cost[1], cost[2]);
    if (round >= 1 && vertex.inside && std::abs(vertex.offset) < 0.6) break;
    if (round == 4) break;
    delay += vertex.inside ? vertex.offset * kFineStep : (cost[0] < cost[2] ? -kFineStep : kFineStep);
  }
  // A cost that hardly depends on the delay (no motion but noise) has a least value too.
  const bool sharp = best.cost < kSharp * median(costs);
  fit.delay_found = options.search_delay && vertex.inside && sharp && std::abs(delay) < options.longest_delay;
  const bool unseen = options.search_delay && !fit.delay_found;
  if (unseen) {  // the least value of a flat cost is noise's: where slow motion hides a delay, scale and arm go with it
    delay = 0.0;
    look(true);
  }

  std::array<Eigen::VectorXd, 3> ends;  // theta of all blocks at the three delays
  const auto solve_all = [&](int without, double& offset, const Eigen::VectorXd* noise) {
    std::array<Eigen::VectorXd, 3> theta;
    std::array<double, 3> cost{};
    for (std::size_t node = 0; node < 3; ++node) {
      Normals sum(columns);
      for (int b = 0; b < blocks; ++b) {
        if (b != without) sum.add(normals[node][static_cast<std::size_t>(b)], 1.0);
      }
      if (noise != nullptr) {
        // Never more than half of a column's energy: a column that is all noise must stay solvable.
        sum.h.diagonal() -= (*noise * sum.weight).cwiseMin(0.5 * sum.h.diagonal());
      }
      theta[node] = sum.solve();
      cost[node] = sum.cost(theta[node]);
    }
    if (noise == nullptr)
      offset = fit.delay_found ? std::clamp(parabola(cost[0], cost[1], cost[2]).offset, -1.0, 1.0) : 0.0;
    if (without < 0 && noise == nullptr) ends = theta;
    return Eigen::VectorXd(through(theta[0], theta[1], theta[2], offset));
  };
  double offset = 0.0;
  fit.theta = solve_all(-1, offset, nullptr);
  fit.delay = options.search_delay ? delay + offset * kFineStep : 0.0;
  // White noise of the sensor adds its variance to the diagonal of the normal equations of M.
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(columns);
  const double sensor_step = std::max(typical_step(sensor.t), problem.step);
  for (int k = 0; k < 3; ++k) {
    std::vector<double> part;
    for (const Eigen::Vector3d& x : sensor.x) part.push_back(x[k]);
    const double sigma = white_noise_sigma(sensor.t, part);
    noise.segment<3>(3 * k).setConstant(sigma * sigma * sensor_step * problem.squared_weight);
  }
  fit.theta_upper = solve_all(-1, offset, &noise);
  for (int b = 0; b < blocks; ++b) {
    double moved = 0.0;
    fit.theta_replicates.push_back(solve_all(b, moved, nullptr));
    fit.delay_replicates.push_back(delay + moved * kFineStep);
    const auto block = static_cast<std::size_t>(b);
    fit.information.push_back(normals[1][block].full());
    const auto square = [&](std::size_t node) { return normals[node][block].square(fit.theta); };
    fit.delay_information.push_back(std::max(square(0) - 2.0 * square(1) + square(2), 0.0) / (kFineStep * kFineStep));
  }
  fit.noise = noise_of(normals[1], fit.theta);
  if (unseen) {
    fit.per_delay = (ends[2] - ends[0]) / (2.0 * kFineStep);
    const double told = delay_uncertainty(fit).sigma;
    fit.unseen_delay = told > 0.0 ? told * kUsualDelay / std::hypot(told, kUsualDelay) : kUsualDelay;
  }

  middle.shift(spline, fit.delay);
  const Misfits misfit = misfits(problem, middle, fit.theta, 1);
  fit.residual = misfit.sigma;
  double squares = 0.0, total = 0.0;
  const double limit = std::max(kOutlier * misfit.typical, options.outlier_floor);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (std::isnan(misfit.error[i].x())) continue;
    add_explained(misfit, i, problem.y[i], squares, total);
    const IncrementProblem::Window& w = problem.windows[i];
    if (misfit.error[i].norm() > limit)
      fit.outlier_times.push_back(problem.t[static_cast<std::size_t>(w.first + w.count / 2)]);
  }
  fit.explained = total > 0.0 ? 1.0 - squares / total : 0.0;
  fit.seconds = span;
  for (int a = 0; a < 3 && problem.lever >= 0; ++a) {
    double energy = 0.0;
    for (const auto& fixed : problem.fixed) energy += fixed.col(problem.lever + a).squaredNorm();
    fit.lever_seen[a] = energy > kLeverSeen * problem.lever_noise * static_cast<double>(problem.fixed.size());
  }
  return fit;
}

}  // namespace fathom::consistency
