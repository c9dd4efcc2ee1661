#include "common/diagnosis/screening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/diagnosis/judgement.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::diagnosis {
namespace {

using identification::ProjectedWindow;

constexpr int kBestStarts = 2;  // descended from
constexpr int kNewtonSteps = 8;
constexpr double kLinearEnough = 0.03;  // missed of the foretold progress: it has arrived
constexpr double kHardly = 1e-3;        // of all progress
constexpr double kBent = 0.3;           // of the foretold progress: then the derivatives are worked out anew
constexpr double kOptimism = 3.0;       // times the foretold progress: a start that cannot even so beat another is left
constexpr double kNothing = 1e-5;       // of the cost: no gain worth a step
constexpr double kSmallStep = 1e-3;     // of the parameter's sigma or value, for differences

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

using EffectParameters = std::span<const model::EffectParameter>;

std::vector<double> clamped(EffectParameters parameters, std::vector<double> theta) {
  for (std::size_t i = 0; i < theta.size(); ++i) theta[i] = std::clamp(theta[i], parameters[i].low, parameters[i].high);
  return theta;
}

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
  base.remove_base(columns);
  for (std::size_t i = 0; i < theta.size(); ++i) {
    auto column = columns.col(static_cast<Eigen::Index>(i));
    if (asked(i)) column = (column - residual) * (parameters[i].sigma / sizes[i]);
  }
  return columns;
}

/// Broyden's update (Nocedal and Wright 2006, sec. 11.1): derivatives that explain the last step's `change`.
void follow_secant(Eigen::MatrixXd& columns, const Eigen::VectorXd& change, EffectParameters parameters,
                   const std::vector<double>& from, const std::vector<double>& to) {
  Eigen::VectorXd step(columns.cols());
  for (std::size_t i = 0; i < from.size(); ++i)
    step[static_cast<Eigen::Index>(i)] = (to[i] - from[i]) / parameters[i].sigma;
  const double square = step.squaredNorm();
  if (square > 0.0) columns += (change - columns * step) * (step.transpose() / square);
}

/// Where a search stands.
struct Point {
  std::vector<double> theta;
  Eigen::MatrixXd residual;  ///< without what the base can imitate, one column
  double cost{};
};

/// The starts that promise most when their amplitudes are where the linear picture wants them. A single one is not
/// asked.
std::vector<Start> best_starts(const Linearisation& base, CandidateModel& candidate, EffectParameters parameters,
                               std::span<const std::vector<double>> starts) {
  if (starts.size() == 1) return {{0.0, starts.front()}};
  const Eigen::VectorXd unfitted = base.stacked_residual();
  std::vector<Start> ranked;
  for (const std::vector<double>& start : starts) {
    Eigen::MatrixXd direction = candidate.residual(start) - unfitted;
    base.remove_base(direction);
    ranked.push_back(with_best_amplitude(parameters, candidate.active().effect->amplitudes(), start,
                                         direction.squaredNorm(), direction.col(0).dot(base.unexplained().col(0))));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Start& a, const Start& b) { return a.gain > b.gain; });
  if (ranked.size() > kBestStarts) ranked.resize(kBestStarts);
  return ranked;
}

/// What a search must reach to be worth its rollouts.
struct Aim {
  double cost_without{};
  double worth{};  ///< share of it; see screen()
  double beat{};   ///< cost that another start has reached
};

/// Damped Gauss-Newton steps from the point, with secant updates while the linear picture holds. `first`: derivatives()
void descend(const Linearisation& base, CandidateModel& candidate, EffectParameters parameters,
             const std::vector<double>& first, const Aim& aim, Point& at) {
  const model::Effect& effect = *candidate.active().effect;
  const std::size_t k = parameters.size();
  double damping = 0.0;
  Eigen::MatrixXd columns;
  bool derive = true, secant = false;
  for (int step = 0; step < kNewtonSteps; ++step) {
    if (std::exchange(derive, false)) {
      secant = false;
      columns = derivatives(base, candidate, at.residual.col(0), parameters, at.theta, first);
    }
    // Unknowns in units of their prior sigma, which is also their prior.
    Eigen::MatrixXd normal = columns.transpose() * columns;
    Eigen::VectorXd gradient = columns.transpose() * at.residual.col(0);
    for (std::size_t i = 0; i < k; ++i) {
      const auto c = static_cast<Eigen::Index>(i);
      normal(c, c) += 1.0 + damping * normal(c, c);
      if (effect.takes_part(candidate.active().variant, i)) gradient[c] += at.theta[i] / parameters[i].sigma;
    }
    const Eigen::VectorXd move = -normal.ldlt().solve(gradient);
    const double foretold = -0.5 * gradient.dot(move);
    if (foretold < kNothing * aim.cost_without || at.cost - kOptimism * foretold > aim.beat) return;
    std::vector<double> next = at.theta;
    for (std::size_t i = 0; i < k; ++i) next[i] += move[static_cast<Eigen::Index>(i)] * parameters[i].sigma;
    const std::vector<double> free = std::exchange(next, clamped(parameters, next));
    if (damping == 0.0 && foretold + std::max(aim.cost_without - at.cost, 0.0) < aim.worth * aim.cost_without) {
      // Not worth a rollout: what the linear picture says of it will do.
      if (next != free) return;
      at.theta = next;
      at.residual += columns * move;
      at.cost = total(base.window_costs(at.residual.col(0)));
      return;
    }
    Eigen::MatrixXd residual = candidate.residual(next);
    base.remove_base(residual);
    const double cost = total(base.window_costs(residual.col(0)));
    if (cost >= at.cost) {
      derive = std::exchange(secant, false);  // the picture was an old one
      if (!derive) damping = damping == 0.0 ? 1.0 : 10.0 * damping;
      continue;
    }
    // Settled: hardly any progress, or as much as the linear picture foretold.
    const double missed = std::abs(at.cost - cost - foretold) / foretold;
    const bool hardly = at.cost - cost < kHardly * (aim.cost_without - cost);
    const bool settled = missed < kLinearEnough || (hardly && !secant);
    derive = missed > kBent || hardly;
    if (!derive) {
      follow_secant(columns, residual.col(0) - at.residual.col(0), parameters, at.theta, next);
      secant = true;
    }
    at = {std::move(next), std::move(residual), cost};
    damping *= 0.1;
    if (settled) return;
  }
}

Point point_at(const Linearisation& base, CandidateModel& candidate, const std::vector<double>& theta) {
  Point at{theta, candidate.residual(theta), 0.0};
  base.remove_base(at.residual);
  at.cost = total(base.window_costs(at.residual.col(0)));
  return at;
}

/// Without the candidate.
Point nothing_of(const Linearisation& base, std::size_t numbers) {
  return {std::vector<double>(numbers, 0.0), base.unexplained(), total(base.window_cost())};
}

/// `step`: the base numbers take the step that goes with it.
Screened told(const Linearisation& base, CandidateModel& candidate, const Point& nothing, const Point& best,
              bool step) {
  const model::ActiveEffect& active = candidate.active();
  Screened screened{.effect = active.effect,
                    .variant = active.variant,
                    .variant_name = active.variant_name,
                    .theta = best.theta,
                    .base = base.fit().model,
                    .gain = nothing.cost - best.cost,
                    .window_cost = base.window_costs(best.residual.col(0)),
                    .signature = best.residual.col(0) - nothing.residual.col(0)};
  if (step && screened.gain > 0.0) base.step_base(candidate.residual(best.theta), screened.base);
  const double norm = screened.signature.norm();
  if (norm > 0.0) screened.signature /= norm;
  screened.change = norm;
  return screened;
}

/// `refining`: the only start is a point found before, not merely the size of a first step away from nothing.
Screened search_from(const Linearisation& base, const model::Effect& effect, int variant,
                     const std::string& variant_name, std::span<const std::vector<double>> starts, bool refining,
                     double worth) {
  CandidateModel candidate{base, effect, variant, variant_name};
  const std::vector<model::EffectParameter> parameters =
      model::parameters_of(effect, variant, *base.fit().model.vehicle);
  // With a single start the effect is near enough to linear for the search to begin at nothing, whose residual is
  // known.
  const bool from_nothing = starts.size() == 1 && !refining;
  const Point nothing = nothing_of(base, parameters.size());
  Point best = nothing;
  for (const Start& start : best_starts(base, candidate, parameters, starts)) {
    Point at = from_nothing ? nothing : point_at(base, candidate, clamped(parameters, start.theta));
    descend(base, candidate, parameters, from_nothing ? start.theta : nothing.theta, {nothing.cost, worth, best.cost},
            at);
    if (at.cost < best.cost) best = std::move(at);
  }
  return told(base, candidate, nothing, best, nothing.cost - best.cost > worth * nothing.cost);
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

Screened seen_by(const Linearisation& base, const Screened& rough) {
  CandidateModel candidate{base, *rough.effect, rough.variant, rough.variant_name};
  const Point nothing = nothing_of(base, rough.theta.size());
  const Point at = point_at(base, candidate, rough.theta);
  return told(base, candidate, nothing, at.cost < nothing.cost ? at : nothing, false);
}

}  // namespace fathom::diagnosis
