#include "common/verdict/covariance.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "common/base/factors.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::verdict {

Eigen::VectorXd after_the_commands_clock(const likelihood::Problem& problem, const likelihood::Fit& fit,
                                         Eigen::VectorXd sigma) {
  const likelihood::NumberSettings& known = problem.number_settings;
  const double clock = known.offset_sigma + known.offset_of_step * problem.input_step;
  const auto& effects = fit.hypothesis.model.effects;
  for (std::size_t j = 0; j < fit.numbers.size() && static_cast<Eigen::Index>(j) < sigma.size(); ++j) {
    const likelihood::Number& number = fit.numbers[j];
    if (number.kind != likelihood::NumberKind::kEffect) continue;
    const model::ActiveEffect& active = effects[static_cast<std::size_t>(number.index)];
    const auto component = static_cast<std::size_t>(number.component);
    if (!model::parameter_of(*active.effect, active.variant, component, *problem.vehicle).after_command) continue;
    double& own = sigma[static_cast<Eigen::Index>(j)];
    own = std::hypot(own, clock);
  }
  return sigma;
}

void put_covariance(const likelihood::Fit& fit, const Eigen::VectorXd& sigma, VerdictGiven& given,
                    const std::set<int>& withheld) {
  const auto p = static_cast<Eigen::Index>(fit.numbers.size());
  if (!fit.finite || p == 0 || sigma.size() != p || fit.information.rows() != p) return;
  const Eigen::MatrixXd inverse = inverse_symmetric(fit.information);
  std::vector<Eigen::Index> told;
  for (Eigen::Index j = 0; j < p; ++j) {
    const likelihood::Number& number = fit.numbers[static_cast<std::size_t>(j)];
    if (number.kind == likelihood::NumberKind::kWeight || !(inverse(j, j) > 0.0)) continue;
    const auto base = model::parameter_from_name(number.name);
    if (base && withheld.contains(model::axis(*base))) continue;
    told.push_back(j);
    given.covariance_of.push_back(number.name);
  }
  for (const Eigen::Index i : told) {
    for (const Eigen::Index j : told)
      given.covariance.push_back(sigma[i] * sigma[j] * inverse(i, j) / std::sqrt(inverse(i, i) * inverse(j, j)));
  }
}

}  // namespace fathom::verdict
