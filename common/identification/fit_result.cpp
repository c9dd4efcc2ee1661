#include "common/identification/fit_result.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/distributions.hpp"
#include "common/identification/parameter_map.hpp"

namespace fathom::identification {

double FitResult::t95() const { return std::sqrt(f_quantile(0.05, freedom)); }

std::vector<NamedValue> FitResult::parameters() const {
  const ParameterMap map{model};
  const Eigen::VectorXd x = map.pack(model);
  std::vector<NamedValue> values;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double variance = map[i].sought && covariance.rows() == x.size() ? std::max(covariance(k, k), 0.0) : 0.0;
    // Between straight lines and inputs that are held lies half a step: even odds over twice that, either way.
    const double held = map[i].after_command ? input_step / std::sqrt(12.0) : 0.0;
    const double std = variance > 0.0 ? std::hypot(std::sqrt(variance), map[i].form_sigma, held) : 0.0;
    NamedValue value{map[i].name, x[k] * map[i].scale, std, map[i].unit};
    if (variance > 0.0) {
      // What the fit does not see adds as variances do.
      const double unseen = kNormal95 * std::hypot(map[i].form_sigma, held), same = t95() * std::sqrt(variance);
      const bool own = i < interval95.size() && interval95[i];
      const double below = own ? value.value - (*interval95[i])[0] : same;
      const double above = own ? (*interval95[i])[1] - value.value : same;
      value.interval95 = {std::max(value.value - std::hypot(below, unseen), std::min(map[i].low, value.value)),
                          std::min(value.value + std::hypot(above, unseen), std::max(map[i].high, value.value))};
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace fathom::identification
