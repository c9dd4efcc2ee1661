#include "common/identification/regression/term_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/factors.hpp"
#include "common/base/spatial.hpp"

namespace fathom::identification {
namespace {

// Of every term, selected or not: as large as the largest that Pereira and Duncan's planar motion tests gave, forces
// and moments apart (Tables 1 to 6). A selected one that came out several times as large has taken something else in.
constexpr double kForcePrior = 0.3, kMomentPrior = 0.02;
constexpr double kWander = 6.0;  // s between knots of a velocity's error: what ranges of every second leave
constexpr double kHalf = std::numbers::sqrt2 / 2.0;  // of a gain's std: half of its variance lasts, half is of one run
constexpr double kAsGood = 2.0;      // natural logarithm of the likelihoods' ratio: seven to one tells nothing apart
constexpr double kCollinear = 1e-8;  // share of a column's square below which it is rounding

struct Normal {
  Eigen::MatrixXd G;  // whitened
  std::vector<int> in;

  [[nodiscard]] Eigen::Index b() const { return G.cols() - 1; }
  [[nodiscard]] Eigen::VectorXd solve(const std::vector<int>& columns) const {
    return solve_symmetric(G(columns, columns), G(columns, Eigen::all).col(b()));
  }
  [[nodiscard]] double left(const std::vector<int>& columns) const {
    const Eigen::VectorXd x = solve(columns);
    return std::max(G(b(), b()) - x.dot(G(columns, Eigen::all).col(b())), 0.0);
  }
};

/// What one standard deviation of each error of instruments and reconstruction does to the residual that the terms
/// leave, a column each: of the gains what lasts through all runs; then of each run the rest of its gains, roll and
/// pitch, and a velocity that wanders, by its values at knots with straight lines between.
class ErrorColumns {
 public:
  ErrorColumns(std::span<const ManoeuvreRows> runs, int axis, const AxisCandidates& candidates,
               const model::Vehicle& vehicle, const RegressionSettings& settings, std::span<const SelectedTerm> terms)
      : axis_{axis}, candidates_{candidates}, vehicle_{vehicle}, settings_{settings} {
    const auto m = static_cast<Eigen::Index>(candidates.terms.size());
    residual_ = Eigen::VectorXd::Zero(m + 1);
    residual_[m] = 1.0;
    for (const SelectedTerm& term : terms) residual_[term.column] = -term.value;
    for (const ManoeuvreRows& run : runs) {
      if (!run.stretches.empty() && !run.stretches.front().empty())
        parts_ = std::max(parts_, run.stretches.front().front().parts.size());
    }
    columns_ = static_cast<Eigen::Index>(parts_);
    for (const ManoeuvreRows& run : runs) {
      first_.push_back(columns_);
      std::size_t rows = 0;
      for (const auto& stretch : run.stretches) rows += stretch.size();
      knots_.push_back(2 + static_cast<Eigen::Index>(static_cast<double>(rows) * run.dt / kWander));
      columns_ += static_cast<Eigen::Index>(parts_) + 2 + 3 * knots_.back();
    }
  }

  /// Candidates, errors, b.
  [[nodiscard]] LaggedGram gram(std::span<const ManoeuvreRows> runs) const {
    LaggedGram gram{residual_.size() + columns_};
    for (std::size_t r = 0; r < runs.size(); ++r) {
      double t = 0.0;  // s of the run before the stretch
      for (const auto& stretch : runs[r].stretches) {
        gram.add(rows(runs[r], r, stretch, t), kOneBlock);
        t += static_cast<double>(stretch.size()) * runs[r].dt;
      }
    }
    return gram;
  }

 private:
  static constexpr int kOneBlock = 1 << 20;  // samples: nobody asks these sums for their scatter
  using Stretch = std::vector<ManoeuvreRows::Row>;

  template <class Change>
  [[nodiscard]] Eigen::VectorXd moved(const Stretch& stretch, const Eigen::VectorXd& before,
                                      const Change& change) const {
    Stretch changed = stretch;
    for (ManoeuvreRows::Row& row : changed) change(row);
    return columns_of(changed, axis_, candidates_, vehicle_, settings_.v_WF) * residual_ - before;
  }

  [[nodiscard]] Eigen::MatrixXd rows(const ManoeuvreRows& run, std::size_t r, const Stretch& stretch, double t) const {
    const Eigen::MatrixXd z = columns_of(stretch, axis_, candidates_, vehicle_, settings_.v_WF);
    const Eigen::Index m = z.cols() - 1;
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(z.rows(), m + columns_ + 1);
    wide.leftCols(m) = z.leftCols(m);
    wide.col(m + columns_) = z.col(m);
    const Eigen::VectorXd before = z * residual_;
    for (std::size_t i = 0; i < parts_; ++i) {
      const double gain = kHalf * (i < run.cells ? settings_.cell_gain : settings_.thrust_gain);
      const auto column = static_cast<Eigen::Index>(i);
      wide.col(m + first_[r] + column) = wide.col(m + column) = moved(stretch, before, [&](ManoeuvreRows::Row& row) {
        if (i < row.parts.size()) row.known += gain * row.parts[i];
      });
    }
    const Eigen::Index first = m + first_[r] + static_cast<Eigen::Index>(parts_), knots = knots_[r];
    for (Eigen::Index i = 0; i < 2; ++i) {
      const Eigen::Quaterniond turn = quaternion_from_rotation_vector(run.sigma_attitude[i] * Eigen::Vector3d::Unit(i));
      wide.col(first + i) = moved(stretch, before, [&](ManoeuvreRows::Row& row) { row.q_WB = row.q_WB * turn; });
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::VectorXd by_velocity =
          moved(stretch, before, [&](ManoeuvreRows::Row& row) { row.nu[i] += run.sigma_velocity[i]; });
      for (Eigen::Index n = 0; n < by_velocity.size(); ++n) {
        const double at = (t + static_cast<double>(n) * run.dt) / kWander;
        const auto knot = std::min(static_cast<Eigen::Index>(at), knots - 2);
        const double share = std::min(at - static_cast<double>(knot), 1.0);
        wide(n, first + 2 + i * knots + knot) = (1.0 - share) * by_velocity[n];
        wide(n, first + 2 + i * knots + knot + 1) = share * by_velocity[n];
      }
    }
    return wide;
  }

  int axis_;
  const AxisCandidates& candidates_;
  const model::Vehicle& vehicle_;
  const RegressionSettings& settings_;
  Eigen::VectorXd residual_;  // of candidates and b
  std::size_t parts_{};
  Eigen::Index columns_{};
  std::vector<Eigen::Index> first_, knots_;  // of each run
};

std::vector<int> equivalents_of(const Normal& normal, int candidates, std::size_t term, double samples) {
  const double left = normal.left(normal.in);
  std::vector<std::pair<double, int>> found;
  for (int j = 0; j < candidates; ++j) {
    if (std::ranges::find(normal.in, j) != normal.in.end()) continue;
    std::vector<int> others = normal.in;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(term));
    const double own = normal.G(j, j);
    if (!(own > 0.0)) continue;
    if (!others.empty()) {
      const Eigen::VectorXd cross = normal.G(others, Eigen::all).col(j);
      if (own - cross.dot(solve_symmetric(normal.G(others, others), cross)) < kCollinear * own) continue;
    }
    others.push_back(j);
    const double worse = 0.5 * samples * std::log(std::max(normal.left(others), 1e-300) / std::max(left, 1e-300));
    if (worse < kAsGood) found.emplace_back(worse, j);
  }
  std::ranges::sort(found);
  std::vector<int> columns;
  for (const auto& [worse, j] : found) columns.push_back(j);
  return columns;
}

}  // namespace

void add_term_errors(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs, int axis,
                     const AxisCandidates& candidates, const RegressionSettings& settings, StepwiseResult& result) {
  if (result.terms.empty()) return;
  const ErrorColumns errors{runs, axis, candidates, vehicle, settings, result.terms};
  Normal normal{errors.gram(runs).whitened(result.phi), {}};
  for (const SelectedTerm& term : result.terms) normal.in.push_back(term.column);
  // Unknowns: selected terms first; then the other terms and the lasting errors.
  const auto terms = static_cast<int>(candidates.terms.size());
  const double prior = axis >= 3 ? kMomentPrior : kForcePrior;
  std::vector<int> all = normal.in;
  std::vector<double> known(normal.in.size(), 1.0 / (prior * prior));  // precisions
  for (int j = 0; j < static_cast<int>(normal.b()); ++j) {
    if (std::ranges::find(normal.in, j) != normal.in.end() || !(normal.G(j, j) > 0.0)) continue;
    all.push_back(j);
    known.push_back(j < terms ? 1.0 / (prior * prior) : 1.0);
  }
  // As much wider as blocks scatter more than white residuals would.
  const double widening = result.samples / std::max(result.effective_samples, 1.0);
  const double variance = std::max(result.sigma * result.sigma * widening, 1e-300);
  Eigen::MatrixXd precision = normal.G(all, all) / variance;
  precision.diagonal() += Eigen::Map<const Eigen::VectorXd>(known.data(), static_cast<Eigen::Index>(known.size()));
  const SymmetricFactor factor{precision};
  const Eigen::MatrixXd covariance = factor.inverse();
  const Eigen::VectorXd mean = factor.solve(normal.G(all, Eigen::all).col(normal.b()) / variance);
  const Eigen::VectorXd least_squares = normal.solve(normal.in);
  for (std::size_t i = 0; i < result.terms.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    SelectedTerm& term = result.terms[i];
    const double square = covariance(row, row) + std::pow(mean[row] - least_squares[row], 2);
    term.unseen = std::sqrt(std::max(square - term.sigma * term.sigma, 0.0));
    term.equivalents = equivalents_of(normal, terms, i, result.effective_samples);
  }
}

}  // namespace fathom::identification
