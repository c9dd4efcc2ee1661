#include "common/diagnosis/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fathom::diagnosis {

double robust_log_likelihood_ratio(std::span<const double> cost_without, std::span<const double> cost_with) {
  const auto n = static_cast<double>(cost_without.size());
  if (n < 2.0) return 0.0;
  double sum = 0.0;
  for (std::size_t w = 0; w < cost_without.size(); ++w) sum += cost_without[w] - cost_with[w];
  if (sum <= 0.0) return 0.0;
  double spread = 0.0;
  for (std::size_t w = 0; w < cost_without.size(); ++w) {
    const double deviation = cost_without[w] - cost_with[w] - sum / n;
    spread += deviation * deviation;
  }
  // A likelihood ratio can never exceed what the costs themselves say were every sample independent.
  const double statistic = spread > 0.0 ? 4.0 * sum * sum / spread : 2.0 * sum;
  // What acts in few windows falls unevenly, and its scatter says nothing against it. So the fall counts at least as
  // much as it would if each window were a single independent observation of unknown variance.
  const double after = std::accumulate(cost_with.begin(), cost_with.end(), 0.0);
  const double single = after > 0.0 ? 0.5 * n * std::log1p(sum / after) : sum;
  return std::min(std::max(0.5 * n * std::log1p(statistic / n), single), sum);
}

double price(int parameters, double windows, int tried) {
  return 0.5 * parameters * std::log(std::max(windows, 2.0)) + std::log(static_cast<double>(std::max(tried, 1)));
}

double log_odds(std::span<const double> cost_without, std::span<const double> cost_with, int parameters, int tried) {
  return robust_log_likelihood_ratio(cost_without, cost_with) -
         price(parameters, static_cast<double>(cost_without.size()), tried);
}

}  // namespace fathom::diagnosis
