// Regression under AR(1): against the literal definition, against QR, and rates over seeds.
#include "common/identification/regression/stepwise.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "common/base/distributions.hpp"
#include "common/identification/regression/block_bootstrap.hpp"

namespace fathom::identification {
namespace {

constexpr double kRounding = 1e-9;

struct Problem {
  Eigen::MatrixXd z;  ///< A and b
  Eigen::VectorXd x;  ///< truth
  std::vector<std::string> names;
};

/// Smooth regressors (sums of slow sines), a residual with memory phi; the first three terms act.
Problem problem(unsigned seed, int samples, int columns, double phi, double sigma = 1.0) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any{0.0, 1.0};
  Problem p;
  p.z.resize(samples, columns + 1);
  for (int j = 0; j < columns; ++j) {
    p.names.push_back("c" + std::to_string(j));
    for (int k = 0; k < samples; ++k) p.z(k, j) = 0.0;
    for (int s = 0; s < 6; ++s) {
      const double a = normal(random), f = 0.2 * any(random), o = 6.3 * any(random);
      for (int k = 0; k < samples; ++k) p.z(k, j) += a * std::sin(f * k + o);
    }
  }
  p.x = Eigen::VectorXd::Zero(columns);
  p.x.head(std::min(3, columns)) << 0.6, -0.5, 0.4;
  double z = sigma / std::sqrt(1.0 - phi * phi) * normal(random);
  for (int k = 0; k < samples; ++k) {
    p.z(k, columns) = p.z.row(k).head(columns).dot(p.x) + z;
    z = phi * z + sigma * normal(random);
  }
  return p;
}

LaggedGram gram_of(const Problem& p, int block = 50) {
  LaggedGram gram{p.z.cols()};
  gram.add(p.z, block);
  return gram;
}

Eigen::MatrixXd whitened_rows(const Eigen::MatrixXd& z, double phi) {
  Eigen::MatrixXd w = z;
  w.row(0) *= std::sqrt(1.0 - phi * phi);
  for (Eigen::Index k = 1; k < z.rows(); ++k) w.row(k) = z.row(k) - phi * z.row(k - 1);
  return w;
}

bool selected(const StepwiseResult& result, int column) {
  return std::any_of(result.terms.begin(), result.terms.end(), [&](const auto& t) { return t.column == column; });
}

/// Forward selection and elimination written out with QR fits of the whitened columns, every sample independent.
std::vector<int> by_qr(const Eigen::MatrixXd& w, double enter, double leave, double collinear) {
  const auto m = static_cast<int>(w.cols()) - 1;
  const Eigen::VectorXd b = w.col(m);
  const auto sse = [&](const std::vector<int>& in) {
    if (in.empty()) return b.squaredNorm();
    const Eigen::MatrixXd A = w(Eigen::all, in);
    return (b - A * A.colPivHouseholderQr().solve(b)).squaredNorm();
  };
  const auto left_over = [&](const std::vector<int>& in, int j) {
    if (in.empty()) return 1.0;
    const Eigen::MatrixXd A = w(Eigen::all, in);
    const Eigen::VectorXd a = w.col(j);
    return (a - A * A.colPivHouseholderQr().solve(a)).squaredNorm() / a.squaredNorm();
  };
  std::vector<int> in;
  for (int turn = 0; turn < 4 * m; ++turn) {
    const double before = sse(in);
    double best = 0.0;
    int entry = -1;
    for (int j = 0; j < m; ++j) {
      if (std::find(in.begin(), in.end(), j) != in.end() || left_over(in, j) <= collinear) continue;
      auto with = in;
      with.push_back(j);
      const double after = sse(with), freedom = static_cast<double>(w.rows()) - static_cast<double>(with.size()) - 1.0;
      const double f = (before - after) / (after / freedom);
      if (f > best && f_tail(f, freedom) <= enter) best = f, entry = j;
    }
    if (entry < 0) break;
    in.push_back(entry);
    for (;;) {
      double worst = leave;
      int exit = -1;
      const double all = sse(in), freedom = static_cast<double>(w.rows()) - static_cast<double>(in.size()) - 1.0;
      for (std::size_t i = 0; i < in.size(); ++i) {
        auto without = in;
        without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
        const double p = f_tail((sse(without) - all) / (all / freedom), freedom);
        if (p > worst) worst = p, exit = static_cast<int>(i);
      }
      if (exit < 0) break;
      in.erase(in.begin() + exit);
    }
  }
  std::sort(in.begin(), in.end());
  return in;
}

}  // namespace

TEST_CASE("Gram: for every phi the sums are those of the whitened rows, first sample kept, also over several blocks") {
  const Problem p = problem(1, 203, 5, 0.8);
  const LaggedGram gram = gram_of(p, 20);
  for (const double phi : {0.0, 0.5, 0.99, -0.3}) {
    const Eigen::MatrixXd w = whitened_rows(p.z, phi);
    CHECK((gram.whitened(phi) - w.transpose() * w).norm() < kRounding * (w.transpose() * w).norm());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(6, 6);
    for (const BlockGram& block : gram.blocks()) sum += gram.whitened(phi, block);
    CHECK((gram.whitened(phi) - sum).norm() < kRounding * sum.norm());
  }
  CHECK(gram.samples() == 203);
}

TEST_CASE("Gram: sums of two runs are those of both together, whatever the number of columns") {
  for (const int columns : {3, 7, 8, 13, 40}) {
    CAPTURE(columns);
    const Problem one = problem(11, 150, columns, 0.8), other = problem(12, 90, columns, 0.8);
    LaggedGram both{columns + 1};
    both.add(gram_of(one, 20));
    both.add(LaggedGram{columns + 1});
    both.add(gram_of(other, 20));
    for (const double phi : {0.0, 0.97}) {
      const Eigen::MatrixXd a = whitened_rows(one.z, phi), b = whitened_rows(other.z, phi);
      const Eigen::MatrixXd sum = a.transpose() * a + b.transpose() * b;
      CHECK((both.whitened(phi) - sum).norm() < kRounding * sum.norm());
    }
    CHECK(both.samples() == 240);
    CHECK(both.stretches() == 2);
    CHECK(both.blocks().size() == gram_of(one, 20).blocks().size() + gram_of(other, 20).blocks().size());
  }
}

TEST_CASE("AR(1): the minimum of the exact sum of squares, found by hand on a fine grid of phi") {
  const Problem p = problem(2, 400, 3, 0.7);
  const AutoregressiveFit fit = fit_autoregressive(gram_of(p), {0, 1, 2});
  double best = 1e300, at = 0.0;
  for (double phi = 0.3; phi < 0.95; phi += 1e-4) {
    const Eigen::MatrixXd w = whitened_rows(p.z, phi);
    const Eigen::MatrixXd A = w.leftCols(3);
    const double sse = (w.col(3) - A * A.colPivHouseholderQr().solve(w.col(3))).squaredNorm();
    if (sse < best) best = sse, at = phi;
  }
  CHECK(fit.phi == doctest::Approx(at).epsilon(3e-4));
  CHECK(fit.sse == doctest::Approx(best).epsilon(1e-6));
}

TEST_CASE("AR(1): standard errors are those of repetition; those of plain least squares are far too small") {
  constexpr int kSeeds = 200;
  double honest = 0.0, plain = 0.0;
  const double zero = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const LaggedGram gram = gram_of(problem(seed, 1500, 3, 0.95));
    const AutoregressiveFit one = fit_autoregressive(gram, {0, 1, 2}),
                            other = fit_autoregressive(gram, {0, 1, 2}, &zero);
    honest += std::pow((one.x[0] - 0.6) / std::sqrt(one.covariance(0, 0)), 2) / kSeeds;
    plain += std::pow((other.x[0] - 0.6) / std::sqrt(other.covariance(0, 0)), 2) / kSeeds;
  }
  MESSAGE("mean square of error over standard error: AR(1) " << honest << ", plain " << plain);
  CHECK(honest > 0.7);  // 200 seeds: 1 +- 0.1
  CHECK(honest < 1.35);
  CHECK(plain > 4.0);
}

TEST_CASE(
    "stepwise: what acts is selected and what does not is refused, with memory in the residual; plain is fooled") {
  constexpr int kSeeds = 50, kColumns = 20;
  int hits = 0, false_ones = 0, plain_false = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Problem p = problem(100 + seed, 1500, kColumns, 0.95, 0.25);
    const LaggedGram gram = gram_of(p);
    const StepwiseResult result = stepwise({gram}, p.names, {});
    const StepwiseResult plain = stepwise({gram}, p.names, {.autoregressive = false, .effective_samples = false});
    for (int j = 0; j < kColumns; ++j) {
      (j < 3 ? hits : false_ones) += selected(result, j) ? 1 : 0;
      if (j >= 3) plain_false += selected(plain, j) ? 1 : 0;
    }
  }
  MESSAGE("selected of 150 that act: " << hits << "; of 850 that do not: " << false_ones << ", plain " << plain_false);
  CHECK(hits >= 148);
  CHECK(false_ones <= 8);  // one in twenty runs, and chance
  CHECK(plain_false > 10 * 8);
}

TEST_CASE("stepwise: correlation that an AR(1) cannot take away widens the standard errors") {
  Problem p = problem(5, 4000, 4, 0.0, 1e-3);
  std::mt19937 random{9};
  std::normal_distribution<double> normal;
  double slow = 0.0, slower = 0.0;  // two poles: one phi leaves the other's memory
  for (int k = 0; k < 4000; ++k) {
    slow = 0.9 * slow + 0.05 * normal(random);
    slower = 0.95 * slower + slow;
    p.z(k, 4) += slower;
  }
  const StepwiseResult result = stepwise({gram_of(p, 200)}, p.names, {});
  CHECK(result.effective_samples < 0.7 * result.samples);
}

TEST_CASE("stepwise: near-collinear candidates, the same selection as QR fits of the whitened columns") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Problem p = problem(seed, 600, 9, 0.8);
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    // Sums of others with ever less of their own: 1e-2, 1e-3, 1e-4 of their size.
    for (int j = 0; j < 3; ++j) {
      const double own = std::pow(10.0, -2 - j);
      for (int k = 0; k < 600; ++k) p.z(k, 6 + j) = p.z(k, j) + p.z(k, 3 + j) + own * normal(random);
    }
    const LaggedGram gram = gram_of(p);
    StepwiseSettings settings{.effective_samples = false};
    const StepwiseResult result = stepwise({gram}, p.names, settings);
    std::vector<int> mine;
    for (const auto& term : result.terms) mine.push_back(term.column);
    CHECK(mine == by_qr(whitened_rows(p.z, result.phi), settings.familywise / 9, 2.0 * settings.familywise / 9,
                        settings.collinear));
  }
}

TEST_CASE("stepwise: thresholds on F select as the probabilities that belong to them, stricter ones select less") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const Problem p = problem(seed, 400, 12, 0.6, 1.0);
    const auto columns = [&](const StepwiseSettings& settings) {
      std::vector<int> in;
      for (const auto& term : stepwise({gram_of(p)}, p.names, settings).terms) in.push_back(term.column);
      return in;
    };
    // With this many samples the quantile hardly depends on how many terms are in.
    const double enter = 0.05 / 12;
    CHECK(columns({.effective_samples = false,
                   .f_in = f_quantile(enter, 396.0),
                   .f_out = f_quantile(2.0 * enter, 396.0)}) == columns({.effective_samples = false}));
    const auto many = columns({.f_in = 1.0, .f_out = 0.9}), few = columns({.f_in = 200.0, .f_out = 100.0});
    CHECK(many.size() > few.size());
    for (const int one : few) CHECK(std::ranges::find(many, one) != many.end());
    CHECK(columns({.f_in = 1e9, .f_out = 1e9}).empty());
  }
}

TEST_CASE("stepwise: constant, zero and collinear regressors are named and not inverted") {
  Problem p = problem(3, 500, 6, 0.5);
  p.z.col(3).setZero();
  p.z.col(4).setConstant(2.5);
  p.z.col(5) = -3.0 * p.z.col(0);
  const StepwiseResult result = stepwise({gram_of(p)}, p.names, {});
  REQUIRE(result.refused.size() == 3);
  CHECK(result.refused[0].why == "zero throughout");
  CHECK(result.refused[1].why == "constant throughout: not to be told from a steady force");
  CHECK(result.refused[2].why == "collinear with c0");
  CHECK(selected(result, 0));
  for (const auto& term : result.terms) CHECK(std::isfinite(term.value));
}

TEST_CASE("stepwise: cross-validation over manoeuvres knows a term that helps from chance") {
  std::vector<LaggedGram> parts;
  std::vector<std::string> names;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Problem p = problem(seed, 500, 4, 0.6, 0.5);
    names = p.names;
    parts.push_back(gram_of(p));
  }
  const StepwiseResult result = stepwise(parts, names, {});
  CHECK(result.cross_validated > 0.1);
  CHECK(result.cross_validated < 1.0);
  CHECK(result.terms.size() == 3);
  CHECK(result.most_significant >= 0);
}

TEST_CASE("bootstrap: its spread is that of the standard errors") {
  const Problem p = problem(8, 4000, 4, 0.8);
  const LaggedGram gram = gram_of(p, 40);
  const AutoregressiveFit fit = fit_autoregressive(gram, {0, 1, 2});
  const Eigen::MatrixXd draws = block_bootstrap(gram, {0, 1, 2}, fit.phi, 1000, 1);
  for (int j = 0; j < 3; ++j) {
    const Eigen::VectorXd centred = draws.col(j).array() - draws.col(j).mean();
    const double spread = std::sqrt(centred.squaredNorm() / 999.0);
    CHECK(spread == doctest::Approx(std::sqrt(fit.covariance(j, j))).epsilon(0.25));  // 100 blocks
    CHECK(draws.col(j).mean() == doctest::Approx(fit.x[j]).epsilon(0.2));
  }
}

}  // namespace fathom::identification
