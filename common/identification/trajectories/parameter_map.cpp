#include "common/identification/trajectories/parameter_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/model/effect_size.hpp"

namespace fathom::identification {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Masses stay above this share of their prior's size: a vehicle without inertia cannot be simulated.
constexpr double kSmallestMassShare = 1e-3;
// What is ordinary on one vehicle is not on another: a prior holds what the data leaves open, and never what it shows.
constexpr double kPriorOpen = 10.0;        // of an effect's number
constexpr double kScaleFloorShare = 0.02;  // of the prior's sigma: the scale of a number that is still zero

}  // namespace

ParameterMap::ParameterMap(const model::Model& model) {
  const model::Vehicle& vehicle = *model.vehicle;
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    const auto parameter = model::parameter_from_name(vehicle.parameters[i]);
    if (!parameter) continue;
    FreeParameter free{
        .base = model::index(*parameter), .name = vehicle.parameters[i], .unit = std::string(model::unit(*parameter))};
    free.prior_mean = vehicle.priors[i].mean;
    free.prior_sigma = vehicle.priors[i].sigma;
    free.scale = std::max(std::abs(model.theta[free.base]), kScaleFloorShare * free.prior_sigma);
    const int sign = model::sign_constraint(*parameter);
    free.low = sign > 0 ? kSmallestMassShare * std::max(free.prior_mean, free.prior_sigma) : -kInfinity;
    free.high = sign < 0 ? 0.0 : kInfinity;
    free_.push_back(std::move(free));
  }
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const model::ActiveEffect& active = model.effects[e];
    const std::size_t count = active.effect->parameters().size();
    const auto same = std::ranges::count(model.effects, active.effect, &model::ActiveEffect::effect);
    const bool several = same > 1 && !active.variant_name.empty();  // the gains of two thrusters
    const std::string form = several ? active.variant_name + "." : "";
    for (std::size_t c = 0; c < count; ++c) {
      const model::EffectParameter parameter = model::parameter_of(*active.effect, active.variant, c, vehicle);
      FreeParameter free{.effect = static_cast<int>(e), .component = static_cast<int>(c)};
      free.name = std::string(active.effect->name()) + "." + form + std::string(parameter.name);
      free.unit = std::string(active.effect->unit(active.variant, c));
      free.prior_sigma = std::max(parameter.sigma, kPriorOpen * std::abs(active.theta[c]));
      free.scale = std::max(std::abs(active.theta[c]), kScaleFloorShare * parameter.sigma);
      free.low = parameter.low;
      free.high = parameter.high;
      free.form_sigma = std::hypot(parameter.form_sigma, active.effect->left_open(active.theta, active.variant, c));
      free.after_command = parameter.after_command;
      free.sought = active.effect->takes_part(active.variant, c);
      if (!free.sought) free.prior_mean = active.theta[c];
      free_.push_back(std::move(free));
    }
  }
}

Eigen::VectorXd ParameterMap::pack(const model::Model& model) const {
  Eigen::VectorXd x(static_cast<Eigen::Index>(free_.size()));
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const FreeParameter& free = free_[i];
    const double value =
        free.base >= 0
            ? model.theta[free.base]
            : model.effects[static_cast<std::size_t>(free.effect)].theta[static_cast<std::size_t>(free.component)];
    x[static_cast<Eigen::Index>(i)] = value / free.scale;
  }
  return x;
}

void ParameterMap::unpack(const Eigen::Ref<const Eigen::VectorXd>& x, model::Model& model) const {
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const FreeParameter& free = free_[i];
    const double value = x[static_cast<Eigen::Index>(i)] * free.scale;
    if (free.base >= 0) {
      model.theta[free.base] = value;
    } else {
      model.effects[static_cast<std::size_t>(free.effect)].theta[static_cast<std::size_t>(free.component)] = value;
    }
  }
}

}  // namespace fathom::identification
