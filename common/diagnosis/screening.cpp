#include "common/diagnosis/screening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/diagnosis/judgement.hpp"
#include "common/identification/outlier.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::diagnosis {
namespace {

using identification::ProjectedWindow;

constexpr int kBestStarts = 2;
constexpr int kNewtonSteps = 8;
constexpr double kLinearEnough = 0.03;
constexpr double kNothing = 1e-5;    // of the cost: no gain worth a step
constexpr double kSmallStep = 1e-3;  // of the parameter's sigma or value, for differences

/// Projected residuals of all windows with the candidate at theta, the base parameters unchanged.
class CandidateModel {
 public:
  CandidateModel(const Linearisation& base, const model::Effect& effect, int variant, const std::string& name)
      : base_{base}, model_{base.fit().model} {
    model_.add({&effect, variant, name, std::vector<double>(effect.parameters().size(), 0.0)});
    const auto place = std::find_if(model_.effects.begin(), model_.effects.end(), [&](const auto& active) {
      return active.effect == &effect && active.variant == variant;
    });
    active_ = &*place;
  }
  [[nodiscard]] const model::ActiveEffect& active() const { return *active_; }

  Eigen::VectorXd residual(const std::vector<double>& theta) {
    active_->theta = theta;
    Eigen::VectorXd all(total_rows());
    Eigen::Index offset = 0;
    for (std::size_t w = 0; w < base_.windows().size(); ++w) {
      const std::size_t place = base_.places()[w];
      const auto& window = base_.problem().windows()[place];
      const ProjectedWindow& projected = base_.windows()[w];
      auto segment = all.segment(offset, window.rows());
      window.evaluate(model_, base_.fit().nu0[place], base_.fit().sigma, trace_, segment);
      segment.array() *= projected.weight.array();
      segment -= projected.initial_basis * (projected.initial_basis.transpose() * segment).eval();
      offset += window.rows();
    }
    return all;
  }

  [[nodiscard]] Eigen::Index total_rows() const {
    Eigen::Index rows = 0;
    for (const ProjectedWindow& window : base_.windows()) rows += window.residual.size();
    return rows;
  }

 private:
  const Linearisation& base_;
  model::Model model_;
  model::ActiveEffect* active_{};
  model::VelocityTrace trace_;
};

/// b -> the part of b that base parameters cannot imitate.
void remove_base(const Linearisation& base, Eigen::MatrixXd& columns) {
  const auto n = base.windows()[0].jacobian.cols();
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n, columns.cols());
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : base.windows()) {
    product += window.jacobian.transpose() * columns.middleRows(offset, window.jacobian.rows());
    offset += window.jacobian.rows();
  }
  const Eigen::MatrixXd step = base.solve(product);
  offset = 0;
  for (const ProjectedWindow& window : base.windows()) {
    columns.middleRows(offset, window.jacobian.rows()) -= window.jacobian * step;
    offset += window.jacobian.rows();
  }
}

/// The step of the base parameters that goes with a residual, inside their limits.
void step_base(const Linearisation& base, const Eigen::VectorXd& residual, model::Model& model) {
  const identification::ParameterMap map{model};
  const Eigen::VectorXd x = map.pack(model);
  Eigen::VectorXd gradient(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    gradient[i] = (free.scale * x[i] - free.prior_mean) * free.scale / (free.prior_sigma * free.prior_sigma);
  }
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : base.windows()) {
    gradient += window.jacobian.transpose() * residual.segment(offset, window.jacobian.rows());
    offset += window.jacobian.rows();
  }
  Eigen::VectorXd next = x - base.solve(gradient);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    next[i] = free.at_bound(x[i]) ? x[i] : std::clamp(next[i], free.low / free.scale, free.high / free.scale);
  }
  map.unpack(next, model);
}

using EffectParameters = std::span<const model::EffectParameter>;

std::vector<double> clamped(EffectParameters parameters, std::vector<double> theta) {
  for (std::size_t i = 0; i < theta.size(); ++i) theta[i] = std::clamp(theta[i], parameters[i].low, parameters[i].high);
  return theta;
}

std::vector<std::size_t> all_places(std::size_t count) {
  std::vector<std::size_t> places(count);
  for (std::size_t i = 0; i < count; ++i) places[i] = i;
  return places;
}

/// What the fit minimises, per window. An outlier counts for less than its square; a candidate that explains it must be
/// credited with what that saves, so this is not the sum of the weighted squares.
std::vector<double> window_costs(const Linearisation& base, const Eigen::VectorXd& residual) {
  std::vector<double> costs;
  Eigen::Index offset = 0;
  for (std::size_t w = 0; w < base.windows().size(); ++w) {
    const ProjectedWindow& window = base.windows()[w];
    const Eigen::VectorXd alone =
        residual.segment(offset, window.residual.size()).array() / window.weight.array();  // as the fit would see it
    costs.push_back(identification::robust_cost(alone, base.problem().windows()[base.places()[w]].axes()));
    offset += window.residual.size();
  }
  return costs;
}

}  // namespace

Linearisation::Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit)
    : Linearisation{problem, fit, problem.linearise(fit), all_places(problem.windows().size())} {}

Linearisation Linearisation::thinned(std::size_t most) const {
  const std::size_t stride = std::max<std::size_t>(1, (windows_.size() + most - 1) / most);
  std::vector<ProjectedWindow> windows;
  std::vector<std::size_t> places;
  for (std::size_t w = 0; w < windows_.size(); w += stride) {
    windows.push_back(windows_[w]);
    places.push_back(places_[w]);
  }
  return {problem_, fit_, std::move(windows), std::move(places)};
}

Linearisation::Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit,
                             std::vector<ProjectedWindow> windows, std::vector<std::size_t> places)
    : problem_{problem}, fit_{fit}, windows_{std::move(windows)}, places_{std::move(places)} {
  const identification::ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    information(i, i) = (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
  }
  for (const ProjectedWindow& window : windows_) information += window.jacobian.transpose() * window.jacobian;
  information_.compute(information);
  unexplained_ = stacked_residual();
  remove_base(*this, unexplained_);
  window_cost_ = window_costs(*this, unexplained_.col(0));
}

Eigen::VectorXd Linearisation::stacked_residual() const {
  Eigen::Index rows = 0;
  for (const ProjectedWindow& window : windows_) rows += window.residual.size();
  Eigen::VectorXd all(rows);
  Eigen::Index offset = 0;
  for (const ProjectedWindow& window : windows_) {
    all.segment(offset, window.residual.size()) = window.residual;
    offset += window.residual.size();
  }
  return all;
}

namespace {

struct Start {
  double gain;
  std::vector<double> theta;
};

/// The start with its amplitudes where the linear picture wants them, inside their limits. `bottom`: squared norm of
/// what the start changes; `top`: its product with what is unexplained.
Start with_best_amplitude(EffectParameters parameters, int amplitudes, std::vector<double> theta, double bottom,
                          double top) {
  if (bottom <= 0.0) return {0.0, theta};
  double share = amplitudes > 0 ? -top / bottom : 1.0;
  for (int i = 0; i < amplitudes; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double wanted = share * theta[k];
    if (wanted != 0.0) share *= std::clamp(wanted, parameters[k].low, parameters[k].high) / wanted;
  }
  for (int i = 0; i < amplitudes; ++i) theta[static_cast<std::size_t>(i)] *= share;
  return {-(share * top + 0.5 * share * share * bottom), theta};
}

/// How `residual` at theta changes with each number, in units of its prior sigma; what base parameters can imitate is
/// taken out. Numbers that are zero move by the whole of `first` where it is not zero, the others by a little.
Eigen::MatrixXd derivatives(const Linearisation& base, CandidateModel& candidate, const Eigen::VectorXd& residual,
                            EffectParameters parameters, const std::vector<double>& theta,
                            const std::vector<double>& first) {
  const model::ActiveEffect& active = candidate.active();
  Eigen::MatrixXd columns(residual.size(), static_cast<Eigen::Index>(theta.size()));
  std::vector<double> sizes(theta.size());
  const auto asked = [&](std::size_t i) { return active.effect->takes_part(active.variant, i); };
  for (std::size_t i = 0; i < theta.size(); ++i) {
    if (!asked(i)) {
      columns.col(static_cast<Eigen::Index>(i)).setZero();
      continue;
    }
    sizes[i] = theta[i] == 0.0 && first[i] != 0.0
                   ? first[i]
                   : kSmallStep * std::max(std::abs(theta[i]), 0.1 * parameters[i].sigma);
    if (theta[i] + sizes[i] > parameters[i].high) sizes[i] = -sizes[i];
    std::vector<double> moved = theta;
    moved[i] += sizes[i];
    columns.col(static_cast<Eigen::Index>(i)) = candidate.residual(moved);
  }
  remove_base(base, columns);
  for (std::size_t i = 0; i < theta.size(); ++i) {
    auto column = columns.col(static_cast<Eigen::Index>(i));
    if (asked(i)) column = (column - residual) * (parameters[i].sigma / sizes[i]);
  }
  return columns;
}

/// `refining`: the only start is a point found before, not merely the size of a first step away from nothing.
Screened search_from(const Linearisation& base, const model::Effect& effect, int variant,
                     const std::string& variant_name, std::span<const std::vector<double>> starts, bool refining,
                     double worth) {
  CandidateModel candidate{base, effect, variant, variant_name};
  const std::vector<model::EffectParameter> parameters =
      model::parameters_of(effect, variant, *base.fit().model.vehicle);
  const std::size_t k = parameters.size();
  const std::vector<double> none(k, 0.0);

  const Eigen::VectorXd unfitted = base.stacked_residual();
  const Eigen::MatrixXd& without = base.unexplained();
  const double cost_without = total(base.window_cost());

  // Rank the starts by what an amplitude along (start - absent) would gain.
  std::vector<Start> ranked;
  for (const auto& start : starts) {
    if (starts.size() == 1) {
      ranked.push_back({0.0, start});
      break;
    }
    Eigen::MatrixXd direction = candidate.residual(start) - unfitted;
    remove_base(base, direction);
    ranked.push_back(with_best_amplitude(parameters, effect.amplitudes(), start, direction.squaredNorm(),
                                         direction.col(0).dot(without.col(0))));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Start& a, const Start& b) { return a.gain > b.gain; });
  if (ranked.size() > kBestStarts) ranked.resize(kBestStarts);

  Screened best{.effect = &effect,
                .variant = variant,
                .variant_name = variant_name,
                .theta = std::vector<double>(k, 0.0),
                .window_cost = {},
                .signature = {}};
  Eigen::VectorXd best_residual = without.col(0);
  double best_cost = cost_without;
  for (const Start& start : ranked) {
    // With a single start the effect is near enough to linear for the search to begin at nothing, whose residual is
    // known.
    const bool from_zero = starts.size() == 1 && !refining;
    std::vector<double> theta = from_zero ? std::vector<double>(k, 0.0) : clamped(parameters, start.theta);
    Eigen::MatrixXd residual = without;
    if (!from_zero) {
      residual = candidate.residual(theta);
      remove_base(base, residual);
    }
    double cost = total(window_costs(base, residual.col(0)));
    double damping = 0.0;
    Eigen::MatrixXd columns;
    bool moved = true;
    for (int step = 0; step < kNewtonSteps; ++step) {
      if (std::exchange(moved, false))
        columns = derivatives(base, candidate, residual.col(0), parameters, theta, from_zero ? start.theta : none);
      // Unknowns in units of their prior sigma, which is also their prior.
      Eigen::MatrixXd normal = columns.transpose() * columns;
      Eigen::VectorXd gradient = columns.transpose() * residual.col(0);
      for (std::size_t i = 0; i < k; ++i) {
        const auto c = static_cast<Eigen::Index>(i);
        normal(c, c) += 1.0 + damping * normal(c, c);
        if (effect.takes_part(variant, i)) gradient[c] += theta[i] / parameters[i].sigma;
      }
      const Eigen::VectorXd move = -normal.ldlt().solve(gradient);
      const double foretold = -0.5 * gradient.dot(move);
      if (foretold < kNothing * cost_without) break;
      std::vector<double> next = theta;
      for (std::size_t i = 0; i < k; ++i) next[i] += move[static_cast<Eigen::Index>(i)] * parameters[i].sigma;
      const std::vector<double> free = std::exchange(next, clamped(parameters, next));
      if (damping == 0.0 && foretold + std::max(cost_without - cost, 0.0) < worth * cost_without) {
        // Not worth a rollout: what the linear picture says of it will do.
        if (next != free) break;
        theta = next;
        residual += columns * move;
        cost = total(window_costs(base, residual.col(0)));
        break;
      }
      Eigen::MatrixXd next_residual = candidate.residual(next);
      remove_base(base, next_residual);
      const double next_cost = total(window_costs(base, next_residual.col(0)));
      if (next_cost >= cost) {
        damping = damping == 0.0 ? 1.0 : 10.0 * damping;
        continue;
      }
      // Settled: hardly any progress, or as much as the linear picture foretold.
      const bool settled = cost - next_cost < 1e-3 * (cost_without - next_cost) ||
                           std::abs(cost - next_cost - foretold) < kLinearEnough * foretold;
      theta = next;
      residual = next_residual;
      moved = true;
      cost = next_cost;
      damping *= 0.1;
      if (settled) break;
    }
    if (cost < best_cost) {
      best_cost = cost;
      best.theta = theta;
      best_residual = residual.col(0);
    }
  }
  best.gain = cost_without - best_cost;
  best.base = base.fit().model;
  if (best.gain > 0.0) step_base(base, candidate.residual(best.theta), best.base);
  best.window_cost = window_costs(base, best_residual);
  best.signature = best_residual - without.col(0);
  const double norm = best.signature.norm();
  if (norm > 0.0) best.signature /= norm;
  return best;
}

}  // namespace

Screened screen(const Linearisation& base, const model::Effect& effect, int variant, const std::string& variant_name,
                std::span<const std::vector<double>> starts, double worth) {
  return search_from(base, effect, variant, variant_name, starts, false, worth);
}

Screened refine(const Linearisation& base, const Screened& rough) {
  const std::vector<std::vector<double>> start{rough.theta};
  return search_from(base, *rough.effect, rough.variant, rough.variant_name, start, true, 0.0);
}

}  // namespace fathom::diagnosis
