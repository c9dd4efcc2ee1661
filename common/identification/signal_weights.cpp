#include "common/identification/signal_weights.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/identification/outlier.hpp"

namespace fathom::identification {
namespace {

constexpr double kTrimmedShare = 0.05;   // worst stretches left out
constexpr double kSmallest = 1e-6;       // below any instrument's noise; keeps perfect data finite
constexpr std::array kShares{0.1, 1.0};  // of the longest stretch over which means are taken

double trimmed_mean(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto kept = std::max<std::size_t>(
      1, values.size() - static_cast<std::size_t>(kTrimmedShare * static_cast<double>(values.size())));
  double sum = 0.0;
  for (std::size_t i = 0; i < kept; ++i) sum += values[i];
  return sum / static_cast<double>(kept);
}

/// Variance of one sample were the residual white, from means over so many seconds (0: of single samples).
double variance_from_means(std::span<const PoseWindow> windows, std::span<const Eigen::VectorXd> residuals, int signal,
                           double seconds) {
  std::vector<double> squares;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const auto count = static_cast<Eigen::Index>(std::max(1L, std::lround(seconds / windows[w].window().trial->dt)));
    for (const AxisRows& rows : windows[w].signals()) {
      if (windows[w].row(rows.first).signal != signal) continue;
      for (Eigen::Index i = 0; i + count <= rows.count; i += count) {
        const double mean = residuals[w].segment(rows.first + i, count).mean();
        squares.push_back(static_cast<double>(count) * mean * mean);
      }
    }
  }
  return trimmed_mean(std::move(squares));
}

}  // namespace

double ordinary_noise(int signal) {
  constexpr double kSpeed = 0.01, kPlace = 0.02, kTurn = 0.01;  // m/s and rad/s, m, rad
  return signal < 6 ? kSpeed : (signal < 9 ? kPlace : kTurn);
}

std::vector<Eigen::VectorXd> signal_weights(std::span<const PoseWindow> windows,
                                            std::span<const Eigen::VectorXd> residuals, double longest) {
  SignalVector white = SignalVector::Zero(), lasting = SignalVector::Zero();
  for (int signal = 0; signal < kSignals; ++signal) {
    white[signal] = variance_from_means(windows, residuals, signal, 0.0);
    lasting[signal] = white[signal];
    for (const double share : kShares)
      lasting[signal] = std::max(lasting[signal], variance_from_means(windows, residuals, signal, share * longest));
  }
  std::vector<Eigen::VectorXd> weights;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const PoseWindow& window = windows[w];
    Eigen::VectorXd scaled(window.rows());
    for (Eigen::Index i = 0; i < window.rows(); ++i)
      scaled[i] = residuals[w][i] / std::max(std::sqrt(white[window.row(i).signal]), kSmallest);
    Eigen::VectorXd weight = robust_weight(scaled, window.signals());
    for (Eigen::Index i = 0; i < window.rows(); ++i)
      weight[i] /= std::max(std::sqrt(lasting[window.row(i).signal]), kSmallest);
    weights.push_back(std::move(weight));
  }
  return weights;
}

}  // namespace fathom::identification
