// A fitted model made ready for questions, and the size of what an effect does in it.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/factors.hpp"
#include "common/inference/scan.hpp"
#include "common/model/driven_axes.hpp"

namespace fathom::inference {

using likelihood::NumberKind;

namespace {

/// Slope of the objective by the numbers; 0 of those that it presses against a limit: they stay there.
Eigen::VectorXd slope_of(const Seen& seen) {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(seen.fit.information.rows());
  for (const likelihood::RunReference& run : seen.reference)
    slope.noalias() -= run.J.transpose() * Eigen::VectorXd{run.slope.reshaped()};
  for (Eigen::Index j = 0; j < slope.size(); ++j) {
    const likelihood::Number& number = seen.fit.numbers[static_cast<std::size_t>(j)];
    const double x = value(seen.fit.hypothesis, number);
    slope[j] -= (x - number.mean) * likelihood::prior_weight(number, x);
    if ((x <= number.low && slope[j] < 0.0) || (x >= number.high && slope[j] > 0.0)) slope[j] = 0.0;
  }
  return slope;
}

}  // namespace

Seen see(const likelihood::Problem& problem, likelihood::Fit fit, int threads) {
  Seen seen{.fit = std::move(fit)};
  likelihood::refer(problem, seen.fit, seen.reference, threads);
  seen.covariance = inverse_symmetric(seen.fit.information);
  seen.step = seen.covariance * slope_of(seen);
  Vector6d square = Vector6d::Zero(), moved = Vector6d::Zero();
  double count = 0.0;
  const std::vector<likelihood::Number> none;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    likelihood::Plant plant{seen.fit.hypothesis, none, problem.runs[r], r, false};
    const auto blocks = problem.runs[r].blocks().size();
    Eigen::MatrixXd inverse(36, static_cast<Eigen::Index>(blocks));
    plant.begin(problem.runs[r].start());
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto at = static_cast<Eigen::Index>(b);
      plant.at_middle(b);
      const Vector6d nu = seen.reference[r].nu_middle.col(at);
      const Vector6d acceleration = plant.acceleration(nu);
      const Matrix6d M = plant.inverse_inertia(nu, acceleration);
      inverse.col(at) = M.reshaped();
      square += (M * (plant.model().allocation * plant.mean_forces().col(at))).cwiseAbs2();
      moved += acceleration.cwiseAbs2();
      count += 1.0;
      plant.end_block(b, seen.reference[r].nu_end.col(at));
    }
    seen.inverse.push_back(std::move(inverse));
  }
  for (int axis = 0; axis < 6; ++axis) {
    if (!model::pushed_along(*problem.vehicle, axis)) square[axis] = moved[axis];
  }
  if (count > 0.0) seen.applied = (square / count).cwiseSqrt();
  return seen;
}

namespace {

/// Of the least squares of `G`, `b` what they take away, numbers that no axis knows held by a small ridge.
Eigen::VectorXd solved(const Eigen::MatrixXd& G, const Eigen::VectorXd& b) {
  constexpr double kRidge = 1e-9;  // of the largest
  const Eigen::VectorXd scale = G.diagonal().cwiseSqrt().unaryExpr([](double x) { return x > 0.0 ? 1.0 / x : 0.0; });
  Eigen::MatrixXd scaled = scale.asDiagonal() * Eigen::MatrixXd{G.selfadjointView<Eigen::Lower>()} * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  const Eigen::VectorXd of = scale.asDiagonal() * b;
  return scale.asDiagonal() * solve_symmetric(scaled, of);
}

/// Square that least squares take away, with numbers from `limit(x)` on held within their limits.
double taken_away(const Eigen::MatrixXd& lower, const Eigen::VectorXd& b, const auto& limit) {
  const Eigen::MatrixXd G = lower.selfadjointView<Eigen::Lower>();
  Eigen::VectorXd x = solved(G, b);
  const Eigen::Index free = limit(x), held = x.size() - free;
  x.head(free) = solved(G.topLeftCorner(free, free), b.head(free) - G.topRightCorner(free, held) * x.tail(held));
  return 2.0 * b.dot(x) - x.dot(G * x);
}

}  // namespace

namespace {

/// `most`: per axis of the filter [m/s^2, rad/s^2].
Size size_of(const likelihood::Problem& problem, const Seen& seen, const std::vector<Eigen::MatrixXd>& accelerations,
             const Vector6d& most) {
  // Base numbers first, then what the clocks of the commands leave open.
  std::vector<Eigen::Index> base;
  for (const NumberKind kind : {NumberKind::kBase, NumberKind::kCommandOffset}) {
    for (std::size_t j = 0; j < seen.fit.numbers.size(); ++j) {
      if (seen.fit.numbers[j].kind == kind) base.push_back(static_cast<Eigen::Index>(j));
    }
  }
  const auto offsets = static_cast<Eigen::Index>(
      std::ranges::count(seen.fit.numbers, NumberKind::kCommandOffset, &likelihood::Number::kind));
  const auto p = static_cast<Eigen::Index>(base.size());
  Size worst;
  for (int i = 0; i < problem.simulated; ++i) {
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(p, p);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(p), row(p);
    double square = 0.0, count = 0.0;
    for (std::size_t r = 0; r < accelerations.size(); ++r) {
      const auto& reference = seen.reference[r];
      for (Eigen::Index k = 0; k < accelerations[r].cols(); ++k) {
        for (Eigen::Index j = 0; j < p; ++j)
          row[j] = reference.B(reference.axes * k + i, base[static_cast<std::size_t>(j)]);
        const double a = accelerations[r](i, k);
        G.selfadjointView<Eigen::Lower>().rankUpdate(row);
        b += a * row;
        square += a * a;
        count += 1.0;
      }
    }
    if (count == 0.0) continue;
    const double left = std::max(0.0, square - taken_away(G, b, [&](Eigen::VectorXd& x) {
                                        for (Eigen::Index j = p - offsets; j < p; ++j) {
                                          const auto of = static_cast<std::size_t>(base[static_cast<std::size_t>(j)]);
                                          const likelihood::Number& number = seen.fit.numbers[of];
                                          const double now = value(seen.fit.hypothesis, number);
                                          x[j] = std::clamp(x[j], number.low - now, number.high - now);
                                        }
                                        return p - offsets;
                                      }));
    const int axis = problem.axes[static_cast<std::size_t>(i)];
    const double rms = std::min(std::sqrt(left / count), most[i]);
    const double share = rms / std::max(seen.applied[axis], 1e-9);
    const double random = seen.fit.noise[static_cast<std::size_t>(i)][likelihood::kForce];
    if (share > worst.share) worst = {share, axis, random > 0.0 ? rms / random : 0.0};
  }
  return worst;
}

}  // namespace

Size size_of(const likelihood::Problem& problem, const Seen& seen, const std::vector<Eigen::MatrixXd>& accelerations) {
  return size_of(problem, seen, accelerations, Vector6d::Constant(std::numeric_limits<double>::infinity()));
}

Size size_of_missing(const likelihood::Problem& problem, const Seen& seen,
                     const std::vector<Eigen::MatrixXd>& accelerations) {
  Vector6d most = Vector6d::Zero();
  for (int i = 0; i < problem.simulated; ++i) most[i] = seen.fit.noise[static_cast<std::size_t>(i)][likelihood::kForce];
  return size_of(problem, seen, accelerations, most);
}

namespace {

/// What an effect adds to a hypothesis without it, at the seen velocities.
struct Added {
  std::vector<Eigen::MatrixXd> accelerations;  ///< per run, axes x blocks
  double shown{};  ///< rms of the change of what the sensors show, over that of the velocity
};

Added added_by(const likelihood::Problem& problem, const Seen& seen, const likelihood::Hypothesis& without,
               const model::ActiveEffect& active) {
  Added added;
  double shown_square = 0.0, moved_square = 0.0;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    EffectColumns columns{problem, seen, without, r};
    columns.add(active, active.theta);
    const auto blocks = problem.runs[r].blocks().size();
    const int axes = seen.reference[r].axes;
    likelihood::RowMatrix acceleration(axes, 1), shown = likelihood::RowMatrix::Zero(axes, 1);
    Eigen::MatrixXd all(axes, static_cast<Eigen::Index>(blocks));
    for (std::size_t b = 0; b < blocks; ++b) {
      shown.setZero();
      columns.at(b, acceleration, shown);
      all.col(static_cast<Eigen::Index>(b)) = acceleration.col(0);
      shown_square += shown.squaredNorm();
      moved_square += seen.reference[r].nu_end.col(static_cast<Eigen::Index>(b)).squaredNorm();
    }
    added.accelerations.push_back(std::move(all));
  }
  if (moved_square > 0.0) added.shown = std::sqrt(shown_square / moved_square);
  return added;
}

}  // namespace

double size_beside(const likelihood::Problem& problem, const Seen& seen, const model::ActiveEffect& active) {
  const Added added = added_by(problem, seen, seen.fit.hypothesis, active);
  return likelihood::stage_of(active) == likelihood::Stage::kSensor ? added.shown
                                                                    : size_of(problem, seen, added.accelerations).share;
}

Size size_of_effect(const likelihood::Problem& problem, const Seen& seen, std::size_t effect, int threads) {
  // The model without it, with what it adds as a column.
  likelihood::Hypothesis without = seen.fit.hypothesis;
  const model::ActiveEffect active = without.model.effects[effect];
  without.model.effects.erase(without.model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  const Added added = added_by(problem, seen, without, active);
  if (likelihood::stage_of(active) == likelihood::Stage::kSensor) return {added.shown, -1};
  if (likelihood::stage_of(active) != likelihood::Stage::kHull) return size_of(problem, seen, added.accelerations);
  // What base numbers alone can do. Beside an effect that couples axes they move axes that are not theirs, through the
  // very inertia that is asked about.
  Seen rest{.fit = seen.fit, .applied = seen.applied};
  rest.fit.hypothesis = without;
  rest.fit.numbers = problem.numbers(without);
  likelihood::refer(problem, rest.fit, rest.reference, threads);
  return size_of(problem, rest, added.accelerations);
}

}  // namespace fathom::inference
