#include "common/identification/two_estimates.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/distributions.hpp"

namespace fathom::identification {
namespace {

constexpr double kParabola = 1.5;  // halves of an interval to one side, beyond which the cost is no parabola
constexpr double kChance = 1e-3;   // of all numbers together, to lie apart by noise

}  // namespace

bool agree(const FitResult& by_fewer, const model::Model& by_more) {
  const ParameterMap map{by_fewer.model};
  const Eigen::VectorXd apart = map.pack(by_more) - map.pack(by_fewer.model);
  double sought = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) sought += map[i].sought ? 1.0 : 0.0;
  const double t_square = f_quantile(kChance / std::max(sought, 1.0), by_fewer.freedom);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double far = apart[k] * map[i].scale, form = map[i].form_sigma;
    if (far * far > t_square * (by_fewer.covariance(k, k) + form * form)) return false;
  }
  return true;
}

std::vector<std::optional<std::array<double, 2>>> drawn_in(const FitResult& by_fewer, const FitResult& by_more) {
  std::vector<std::optional<std::array<double, 2>>> ends(by_fewer.interval95.size());
  const std::vector<NamedValue> before = by_fewer.parameters(), after = by_more.parameters();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (!by_fewer.interval95[i]) continue;
    const auto k = static_cast<Eigen::Index>(i);
    const double half_before = by_fewer.t95() * std::sqrt(by_fewer.covariance(k, k));
    const double half_after = by_more.t95() * std::sqrt(by_more.covariance(k, k));
    const auto end = [&](double was) {
      const double away = was - before[i].value;
      return std::abs(away) > kParabola * half_before ? was : after[i].value + half_after / half_before * away;
    };
    ends[i] = {std::min(end((*by_fewer.interval95[i])[0]), after[i].value),
               std::max(end((*by_fewer.interval95[i])[1]), after[i].value)};
  }
  return ends;
}

}  // namespace fathom::identification
