#include "common/diagnosis/few_windows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/statistics.hpp"
#include "common/diagnosis/held_out.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::ProjectedWindow;
using identification::TrajectoryFit;
using identification::WindowResidual;

constexpr double kMemories = 5.0;  // in a piece, so that neighbours share a tenth of what they say at most
constexpr double kMostPieces = 8;  // of a window: the scatter of scores over shorter ones is that of single swings

struct Piece {
  Eigen::MatrixXd information;  ///< J'J
  Eigen::VectorXd gradient;     ///< J'r
};

double length(const WindowResidual& window) {
  return window.rows() > 0 ? window.time(window.axes().back().first + window.axes().back().count - 1) -
                                 window.time(window.axes().back().first)
                           : 0.0;
}

/// Sum over the axes of J v r at each time, in the order of time.
std::vector<double> scores(const WindowResidual& window, const ProjectedWindow& projected,
                           const Eigen::VectorXd& direction) {
  const Eigen::VectorXd each = (projected.jacobian * direction).cwiseProduct(projected.residual);
  Eigen::Index longest = 0;
  for (const auto& axis : window.axes()) longest = std::max(longest, axis.count);
  std::vector<double> sum(static_cast<std::size_t>(longest), 0.0);
  for (const auto& axis : window.axes()) {
    for (Eigen::Index i = 0; i < axis.count; ++i) sum[static_cast<std::size_t>(i)] += each[axis.first + i];
  }
  return sum;
}

std::vector<Piece> cut(const TrajectoryFit& problem, std::span<const ProjectedWindow> windows, double memory) {
  std::vector<Piece> pieces;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const WindowResidual& window = problem.windows()[w];
    const double lasts = length(window);
    const double count = std::clamp(std::floor(lasts / (kMemories * memory)), 1.0, kMostPieces);
    const Eigen::Index n = windows[w].jacobian.cols();
    const std::size_t first = pieces.size();
    pieces.resize(first + static_cast<std::size_t>(count), {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)});
    if (window.rows() == 0) continue;
    double begin = window.time(0);
    for (const auto& axis : window.axes()) begin = std::min(begin, window.time(axis.first));
    for (const auto& axis : window.axes()) {
      for (Eigen::Index i = axis.first; i < axis.first + axis.count;) {
        const auto piece_of = [&](Eigen::Index row) {
          const double share = lasts > 0.0 ? (window.time(row) - begin) / lasts : 0.0;
          return static_cast<std::size_t>(std::clamp(std::floor(share * count), 0.0, count - 1.0));
        };
        Eigen::Index end = i + 1;
        while (end < axis.first + axis.count && piece_of(end) == piece_of(i)) ++end;
        const auto J = windows[w].jacobian.middleRows(i, end - i);
        Piece& piece = pieces[first + piece_of(i)];
        piece.information += J.transpose() * J;
        piece.gradient += J.transpose() * windows[w].residual.segment(i, end - i);
        i = end;
      }
    }
  }
  return pieces;
}

}  // namespace

double memory_of_scores(const TrajectoryFit& problem, std::span<const ProjectedWindow> windows,
                        const Eigen::VectorXd& direction) {
  std::vector<double> products;  // by lag, over all windows
  double seconds = 0.0, steps = 0.0;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const std::vector<double> z = scores(problem.windows()[w], windows[w], direction);
    products.resize(std::max(products.size(), z.size()), 0.0);
    for (std::size_t lag = 0; lag < z.size(); ++lag) {
      for (std::size_t i = lag; i < z.size(); ++i) products[lag] += z[i] * z[i - lag];
    }
    seconds += length(problem.windows()[w]);
    steps += std::max(static_cast<double>(z.size()) - 1.0, 0.0);
  }
  if (products.empty() || !(products[0] > 0.0) || !(steps > 0.0)) return 0.0;
  // Summed as far as five memories (Sokal 1997, eq. 3.20): farther on there is only noise.
  double memory = 1.0;
  for (std::size_t lag = 1; lag < products.size() && static_cast<double>(lag) < kMemories * memory; ++lag)
    memory += 2.0 * products[lag] / products[0];
  return std::max(memory, 1.0) * seconds / steps;
}

double ratio_where_it_acts(const TrajectoryFit& problem, const FitResult& fit, std::span<const Eigen::Index> places) {
  const identification::ParameterMap map{fit.model};
  const auto n = static_cast<Eigen::Index>(map.size());
  std::vector<ProjectedWindow> windows = problem.linearise(fit);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd scatter = Eigen::VectorXd::Zero(n);
  for (ProjectedWindow& window : windows) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (keeps_its_value(map[static_cast<std::size_t>(i)], fit.model)) window.jacobian.col(i).setZero();
    }
    information += window.jacobian.transpose() * window.jacobian;
    scatter += (window.jacobian.transpose() * window.residual).cwiseAbs2();
  }
  std::vector<Eigen::Index> known;  // without what keeps its value: no window says anything of it
  for (const Eigen::Index place : places) {
    if (information(place, place) > 0.0) known.push_back(place);
  }
  if (known.empty()) return 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    // Correlated residuals overstate the information by this factor; against the prior it must not count.
    const double inflation = information(i, i) > 0.0 ? std::max(1.0, scatter[i] / information(i, i)) : 1.0;
    const auto& free = map[static_cast<std::size_t>(i)];
    information(i, i) += inflation * std::pow(free.scale / free.prior_sigma, 2);
  }
  const Eigen::LDLT<Eigen::MatrixXd> all{information};
  const Eigen::VectorXd x = map.pack(fit.model)(known);
  const auto from_known = [&](const Eigen::VectorXd& weighted) {
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(n);
    direction(known) = weighted;
    return Eigen::VectorXd{all.solve(direction)};
  };
  const Eigen::MatrixXd inverse = all.solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd expected = inverse(known, known);  // covariance, were what is left white
  const double memory = memory_of_scores(problem, windows, from_known(expected.ldlt().solve(x)));

  const std::vector<Piece> pieces = cut(problem, windows, memory);
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(n, n);
  for (const Piece& piece : pieces) {
    const Eigen::VectorXd moved = (information - piece.information).ldlt().solve(piece.gradient);
    moves += moved * moved.transpose();  // how far the parameters move when this piece is left out
  }
  const Eigen::MatrixXd covariance = moves(known, known);
  const Eigen::LDLT<Eigen::MatrixXd> solver{covariance};
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) return 0.0;
  const Eigen::VectorXd weighted = solver.solve(x);
  const Eigen::VectorXd influence = from_known(weighted);
  std::vector<double> shares;
  for (const Piece& piece : pieces) shares.push_back(influence.dot(piece.information * influence));
  const double informative = effective_count(shares);
  const double wald = x.dot(weighted);
  return informative > 1.0 && wald > 0.0 ? 0.5 * informative * std::log1p(wald / informative) : 0.0;
}

}  // namespace fathom::diagnosis
