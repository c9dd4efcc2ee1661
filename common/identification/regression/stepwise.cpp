#include "common/identification/regression/stepwise.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/distributions.hpp"

namespace fathom::identification {
namespace {

constexpr double kConstant = 1e-12;  // square of a column's steps over its own below which it never moves
constexpr int kMostRounds = 8;       // of selection and phi
constexpr double kPhiSettled = 1e-4;
constexpr double kFewestFreedom = 3.0;
constexpr int kSamplesPerColumn = 10;  // below which the full model is no guide to phi

using Columns = std::vector<int>;

/// The whitened Gram at one phi in units in which every column's square is one, and what a set of columns leaves over.
/// Cholesky on correlations: a candidate is judged by what is new in it, and never enters when that is rounding.
class Selection {
 public:
  Selection(const LaggedGram& gram, double phi, const StepwiseSettings& settings)
      : gram_{gram}, phi_{phi}, settings_{settings}, R_{gram.whitened(phi)} {
    scale_ = R_.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (double& one : scale_) one = one > 0.0 ? one : 1.0;
    R_ = scale_.cwiseInverse().asDiagonal() * R_ * scale_.cwiseInverse().asDiagonal();
    set({});
  }

  void set(const Columns& columns) {
    in_ = columns;
    const auto k = static_cast<Eigen::Index>(in_.size());
    if (k > 0) {
      factor_.compute(R_(in_, in_));
      W_ = factor_.matrixL().solve(R_(in_, Eigen::all));
    } else {
      W_.resize(0, R_.cols());
    }
    left_ = R_.diagonal() - W_.colwise().squaredNorm().transpose();
    with_b_ = R_.col(b()) - W_.transpose() * W_.col(b());
  }

  [[nodiscard]] double left_over(int j) const { return left_[j]; }
  [[nodiscard]] double sse() const { return std::max(left_[b()], 0.0); }
  [[nodiscard]] double freedom(std::size_t terms) const {
    double n = gram_.samples() - static_cast<double>(terms) - 1.0;
    if (settings_.effective_samples) n = std::min(n, static_cast<double>(gram_.blocks().size() - terms));
    return std::max(n, kFewestFreedom);
  }
  [[nodiscard]] double samples_left(std::size_t terms) const {
    return std::max(gram_.samples() - static_cast<double>(terms) - 1.0, 1.0);
  }
  /// F of candidate j beside those in the set, every whitened sample independent.
  [[nodiscard]] double f_entering(int j) const {
    const double gain = with_b_[j] * with_b_[j] / left_[j];
    return gain / (std::max(sse() - gain, 1e-300) / samples_left(in_.size() + 1));
  }
  /// Value of j (scaled units) and how many times its variance exceeds that of white residuals, when it joins the set.
  [[nodiscard]] double widening_entering(int j) const {
    Eigen::VectorXd r = Eigen::VectorXd::Zero(R_.cols()), c = r;
    const double value = with_b_[j] / left_[j];
    project(j, r);
    project(b(), c);
    c -= value * r;
    const double variance = std::max(sse() - value * with_b_[j], 0.0) / samples_left(in_.size() + 1);
    return widening(r, c, variance * left_[j]);
  }
  struct Standing {
    double value{}, variance{}, widening{1.0};
  };
  /// The i-th of the set, in the columns' own units.
  [[nodiscard]] Standing standing(std::size_t i) const {
    const auto k = static_cast<Eigen::Index>(in_.size());
    const auto row = static_cast<Eigen::Index>(i);
    const Eigen::VectorXd unit = factor_.solve(Eigen::VectorXd::Unit(k, row));  // row of the inverse
    const Eigen::VectorXd x = factor_.matrixU().solve(W_.col(b()));
    const double white = sse() / samples_left(in_.size());
    Standing result;
    const double units = scale_[b()] / scale_[in_[i]];
    result.value = x[row] * units;
    result.variance = white * unit[row] * units * units;
    Eigen::VectorXd r = Eigen::VectorXd::Zero(R_.cols()), c = r;
    for (Eigen::Index m = 0; m < k; ++m) r[in_[static_cast<std::size_t>(m)]] = unit[m] / unit[row];
    project(b(), c);
    result.widening = widening(r, c, white / unit[row]);
    return result;
  }
  /// The column of the set that is most like j.
  [[nodiscard]] int partner(int j) const {
    const Eigen::VectorXd share = factor_.matrixU().solve(W_.col(j));
    Eigen::Index most = 0;
    share.cwiseAbs().maxCoeff(&most);
    return in_[static_cast<std::size_t>(most)];
  }
  [[nodiscard]] double correlation(int i, int j) const { return R_(i, j); }
  [[nodiscard]] const Columns& columns() const { return in_; }

 private:
  [[nodiscard]] Eigen::Index b() const { return R_.cols() - 1; }
  /// Column j less its projection onto the set, as a combination of columns.
  void project(Eigen::Index j, Eigen::VectorXd& r) const {
    if (!in_.empty()) {
      const Eigen::VectorXd share = factor_.matrixU().solve(W_.col(j));
      for (std::size_t i = 0; i < in_.size(); ++i) r[in_[i]] = -share[static_cast<Eigen::Index>(i)];
    }
    r[j] = 1.0;
  }
  /// Sum over blocks of (sum of r w e)^2 over what white e would give: 1 when whitening left nothing correlated.
  [[nodiscard]] double widening(const Eigen::VectorXd& r, const Eigen::VectorXd& c, double expected) const {
    if (!settings_.effective_samples || gram_.blocks().size() < 4 || !(expected > 0.0)) return 1.0;
    std::vector<Eigen::Index> rows, columns;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      if (r[i] != 0.0) rows.push_back(i);
      if (c[i] != 0.0) columns.push_back(i);
    }
    const double k = 1.0 - phi_;
    double sum = 0.0;
    for (const BlockGram& block : gram_.blocks()) {
      double steps = 0.0, lagged = 0.0, r_last = 0.0, r_before = 0.0, c_last = 0.0, c_before = 0.0;
      for (const Eigen::Index m : columns) {
        const double weight = c[m] / scale_[m];
        c_last += weight * block.last[m];
        c_before += weight * block.before[m];
        double of_steps = 0.0, of_lagged = 0.0;
        for (const Eigen::Index i : rows) {
          of_steps += r[i] / scale_[i] * block.steps(i, m);
          of_lagged += r[i] / scale_[i] * block.lagged(i, m);
        }
        steps += weight * of_steps;
        lagged += weight * of_lagged;
      }
      for (const Eigen::Index i : rows) {
        r_last += r[i] / scale_[i] * block.last[i];
        r_before += r[i] / scale_[i] * block.before[i];
      }
      double score = phi_ * steps + k * k * lagged + k * (r_last * c_last - r_before * c_before);
      if (block.opens) score += (1.0 - phi_ * phi_) * r_before * c_before;
      sum += score * score;
    }
    return std::max(1.0, sum / expected);
  }

  const LaggedGram& gram_;
  double phi_;
  const StepwiseSettings& settings_;
  Eigen::MatrixXd R_;
  Eigen::VectorXd scale_;
  Columns in_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd W_;
  Eigen::VectorXd left_, with_b_;
};

/// What F a term needs to enter, and to stay.
class Thresholds {
 public:
  Thresholds(const StepwiseSettings& settings, std::size_t candidates)
      : settings_{settings}, enter_{settings.familywise / std::max<double>(1.0, static_cast<double>(candidates))} {}
  [[nodiscard]] bool enters(double f, double freedom) const {
    return settings_.f_in ? f >= *settings_.f_in : f_tail(f, freedom) <= enter_;
  }
  [[nodiscard]] bool leaves(double f, double freedom) const {
    return settings_.f_out ? f < *settings_.f_out : f_tail(f, freedom) > settings_.leave_factor * enter_;
  }

 private:
  const StepwiseSettings& settings_;
  double enter_;
};

/// Candidates with the most promising first; the widened F is never larger than the plain one, so that few are asked.
std::optional<int> best_entry(const Selection& selection, const Columns& candidates, const StepwiseSettings& settings,
                              const Thresholds& thresholds) {
  std::vector<std::pair<double, int>> ranked;
  for (const int j : candidates) {
    if (std::find(selection.columns().begin(), selection.columns().end(), j) != selection.columns().end()) continue;
    if (selection.left_over(j) > settings.collinear) ranked.emplace_back(selection.f_entering(j), j);
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  double best_f = 0.0;
  std::optional<int> best;
  const double freedom = selection.freedom(selection.columns().size() + 1);
  for (const auto& [f, j] : ranked) {
    if (f <= best_f || !thresholds.enters(f, freedom)) break;
    const double widened = f / selection.widening_entering(j);
    if (widened <= best_f || !thresholds.enters(widened, freedom)) continue;
    best_f = widened;
    best = j;
  }
  return best;
}

std::optional<std::size_t> worst_term(const Selection& selection, const Thresholds& thresholds) {
  std::optional<std::size_t> worst;
  double lowest = 0.0;
  const std::size_t k = selection.columns().size();
  for (std::size_t i = 0; i < k; ++i) {
    const auto one = selection.standing(i);
    const double f = one.value * one.value / (one.variance * one.widening);
    if (!thresholds.leaves(f, selection.freedom(k)) || (worst && f >= lowest)) continue;
    lowest = f;
    worst = i;
  }
  return worst;
}

Columns select(const LaggedGram& gram, double phi, const Columns& candidates, const StepwiseSettings& settings) {
  const Thresholds thresholds{settings, candidates.size()};
  Selection selection{gram, phi, settings};
  Columns in;
  // Every entry lowers the sum of squares and every exit raises it by less; the bound is for ties of rounding alone.
  for (std::size_t turn = 0; turn < 4 * candidates.size(); ++turn) {
    if (static_cast<int>(in.size()) >= settings.most) break;
    const auto entry = best_entry(selection, candidates, settings, thresholds);
    if (!entry) break;
    in.push_back(*entry);
    selection.set(in);
    while (const auto exit = worst_term(selection, thresholds)) {
      in.erase(in.begin() + static_cast<std::ptrdiff_t>(*exit));
      selection.set(in);
    }
  }
  std::sort(in.begin(), in.end());
  return in;
}

/// Candidates that can be judged at all; the others are named.
Columns admissible(const LaggedGram& gram, const std::vector<std::string>& names, const StepwiseSettings& settings,
                   std::vector<RefusedColumn>& refused) {
  const Eigen::MatrixXd plain = gram.plain();
  const Eigen::VectorXd steps = gram.whitened(1.0).diagonal();
  Columns candidates;
  for (int j = 0; j + 1 < static_cast<int>(plain.cols()); ++j) {
    if (!(plain(j, j) > 0.0)) {
      refused.push_back({j, "zero throughout"});
      continue;
    }
    if (steps[j] <= kConstant * plain(j, j)) {
      refused.push_back({j, "constant throughout: not to be told from a steady force"});
      continue;
    }
    const auto twin = std::find_if(candidates.begin(), candidates.end(), [&](int i) {
      const double cosine = plain(i, j) / std::sqrt(plain(i, i) * plain(j, j));
      return 1.0 - cosine * cosine < settings.collinear;
    });
    if (twin != candidates.end()) {
      refused.push_back({j, "collinear with " + names[static_cast<std::size_t>(*twin)]});
      continue;
    }
    candidates.push_back(j);
  }
  return candidates;
}

/// As many candidates as are not combinations of those before them.
Columns independent(const LaggedGram& gram, const Columns& candidates, const StepwiseSettings& settings) {
  Selection selection{gram, 0.9, settings};
  Columns in;
  for (const int j : candidates) {
    if (selection.left_over(j) < 1e3 * settings.collinear) continue;
    in.push_back(j);
    selection.set(in);
  }
  return in;
}

double cross_validate(const std::vector<LaggedGram>& parts, const Columns& columns, double phi) {
  double left = 0.0, all = 0.0;
  for (std::size_t out = 0; out < parts.size(); ++out) {
    LaggedGram others{parts[out].columns()};
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (i != out) others.add(parts[i]);
    }
    const AutoregressiveFit fit = fit_autoregressive(others, columns, &phi);
    Eigen::VectorXd c = Eigen::VectorXd::Zero(parts[out].columns());
    c[c.size() - 1] = 1.0;
    for (std::size_t i = 0; i < columns.size(); ++i) c[columns[i]] = -fit.x[static_cast<Eigen::Index>(i)];
    const Eigen::MatrixXd G = parts[out].whitened(phi);
    left += c.dot(G * c);
    all += G(G.rows() - 1, G.cols() - 1);
  }
  return all > 0.0 ? 1.0 - left / all : 0.0;
}

}  // namespace

StepwiseResult stepwise(const std::vector<LaggedGram>& parts, const std::vector<std::string>& names,
                        const StepwiseSettings& settings) {
  StepwiseResult result;
  LaggedGram gram{static_cast<Eigen::Index>(names.size()) + 1};
  for (const LaggedGram& part : parts) gram.add(part);
  result.samples = gram.samples();
  const Columns candidates = admissible(gram, names, settings, result.refused);
  double phi = 0.0;
  if (settings.autoregressive) {
    // The fullest model is the best guide to the residual's memory: a term that is still missing looks like memory.
    const Columns full = independent(gram, candidates, settings);
    const bool enough = gram.samples() > kSamplesPerColumn * static_cast<int>(full.size());
    phi = fit_autoregressive(gram, enough ? full : Columns{}).phi;
  }
  Columns in = select(gram, phi, candidates, settings);
  AutoregressiveFit fit = fit_autoregressive(gram, in, settings.autoregressive ? nullptr : &phi);
  for (int round = 0; round < kMostRounds && std::abs(fit.phi - phi) > kPhiSettled; ++round) {
    phi = fit.phi;
    const Columns again = select(gram, phi, candidates, settings);
    const bool same = again == in;
    in = again;
    fit = fit_autoregressive(gram, in);
    if (same) break;
  }
  result.phi = fit.phi;
  result.phi_sigma = settings.autoregressive ? fit.phi_sigma : 0.0;
  result.sigma = std::sqrt(fit.variance);

  Selection selection{gram, fit.phi, settings};
  selection.set(in);
  double widening = 0.0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto one = selection.standing(i);
    SelectedTerm term{.column = in[i], .value = one.value, .sigma = std::sqrt(one.variance * one.widening)};
    term.f = one.value * one.value / (one.variance * one.widening);
    term.p = f_tail(term.f, selection.freedom(in.size()));
    widening += one.widening / static_cast<double>(in.size());
    if (result.most_significant < 0 || term.f > result.terms[static_cast<std::size_t>(result.most_significant)].f) {
      result.most_significant = static_cast<int>(i);
    }
    result.terms.push_back(term);
  }
  result.effective_samples = in.empty() ? gram.samples() : gram.samples() / widening;
  for (const int j : candidates) {
    if (in.empty() || std::find(in.begin(), in.end(), j) != in.end()) continue;
    if (selection.left_over(j) > settings.collinear) continue;
    result.refused.push_back({j, "collinear with " + names[static_cast<std::size_t>(selection.partner(j))] +
                                     " and others that are selected"});
  }
  Eigen::VectorXd c = Eigen::VectorXd::Zero(gram.columns());
  c[c.size() - 1] = 1.0;
  for (const SelectedTerm& term : result.terms) c[term.column] = -term.value;
  const Eigen::MatrixXd plain = gram.plain();
  const double total = plain(plain.rows() - 1, plain.cols() - 1);
  result.explained = total > 0.0 ? 1.0 - c.dot(plain * c) / total : 0.0;
  if (parts.size() > 1 && !in.empty()) {
    result.cross_validated = cross_validate(parts, in, fit.phi);
  } else if (gram.blocks().size() >= 10 && !in.empty()) {
    constexpr std::size_t kPieces = 5;
    std::vector<LaggedGram> pieces;
    const std::size_t n = gram.blocks().size();
    for (std::size_t i = 0; i < kPieces; ++i) {
      pieces.push_back(gram.part(i * n / kPieces, (i + 1) * n / kPieces - i * n / kPieces));
    }
    result.cross_validated = cross_validate(pieces, in, fit.phi);
  }
  return result;
}

}  // namespace fathom::identification
