#include "common/likelihood/hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/likelihood/effect_stages.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kSmallestMass = 1e-3;  // of the prior's size: without inertia nothing can be simulated
constexpr double kStep = 1e-5;          // of a number's size, for differences
constexpr double kLeastSize = 1e-2;     // of the prior's sigma: size of a number that is still zero
// Of clocks and of how commands are held between their stamps; what is later than that acts late, and has a name.
constexpr double kOffsetSigmas = 2.0, kOffsetOfStep = 0.5;

void add_base(const Hypothesis& hypothesis, std::vector<Number>& numbers) {
  const model::Vehicle& vehicle = *hypothesis.model.vehicle;
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    const auto parameter = model::parameter_from_name(vehicle.parameters[i]);
    if (!parameter) continue;
    Number number{.kind = NumberKind::kBase,
                  .index = model::index(*parameter),
                  .name = vehicle.parameters[i],
                  .unit = std::string(model::unit(*parameter)),
                  .mean = vehicle.priors[i].mean,
                  .sigma = vehicle.priors[i].sigma};
    const int sign = model::sign_constraint(*parameter);
    if (sign > 0) number.low = kSmallestMass * std::max(number.mean, number.sigma);
    if (sign < 0) number.high = 0.0;
    numbers.push_back(std::move(number));
  }
}

void add_run(std::size_t run, const NumberSettings& settings, double input_step, std::size_t runs,
             std::vector<Number>& numbers) {
  const std::string of = runs > 1 ? " of run " + std::to_string(run + 1) : "";
  const auto add = [&](NumberKind kind, int index, const std::string& name, const char* unit, double sigma) {
    numbers.push_back(
        {.kind = kind, .index = index, .run = static_cast<int>(run), .name = name + of, .unit = unit, .sigma = sigma});
  };
  if (settings.command_offset) {
    add(NumberKind::kCommandOffset, 0, "command offset", "s",
        settings.offset_sigma + settings.offset_of_step * input_step);
    const double most = kOffsetSigmas * settings.offset_sigma + kOffsetOfStep * input_step;
    numbers.back().low = -most;
    numbers.back().high = most;
    numbers.back().step = 1e-3;
  }
  constexpr std::array<const char*, 3> kWorld{"force north", "force east", "force down"};
  for (int i = 0; i < 3 && settings.world_force; ++i)
    add(NumberKind::kWorldForce, i, kWorld[static_cast<std::size_t>(i)], "N", settings.world_force_sigma);
  for (int i = 0; i < 6 && settings.velocity_bias; ++i)
    add(NumberKind::kVelocityBias, i, std::string("bias of ") + model::kVelocityNames[static_cast<std::size_t>(i)],
        i < 3 ? "m/s" : "rad/s", settings.bias_sigma);
}

}  // namespace

std::vector<Number> numbers_of(const Hypothesis& hypothesis, const NumberSettings& settings, double input_step,
                               double t_low, double t_high) {
  std::vector<Number> numbers;
  add_base(hypothesis, numbers);
  for (std::size_t e = 0; e < hypothesis.model.effects.size(); ++e)
    add_effect_numbers(hypothesis.model, e, t_low, t_high, numbers);
  for (const FeatureGroup& group : hypothesis.force.groups) {
    for (int j = group.first; j < group.first + group.count; ++j) {
      numbers.push_back({.kind = NumberKind::kWeight,
                         .index = j,
                         .name = group.kind + " " + std::to_string(j),
                         .sigma = group.sigma,
                         .step = 1.0});
    }
  }
  for (std::size_t r = 0; r < hypothesis.runs.size(); ++r)
    add_run(r, settings, input_step, hypothesis.runs.size(), numbers);
  for (Number& number : numbers) {
    if (number.step == 0.0)
      number.step = kStep * std::max(std::abs(value(hypothesis, number)), kLeastSize * number.sigma);
  }
  return numbers;
}

model::Model model_of(const Hypothesis& hypothesis, double input_step) {
  model::Model model = hypothesis.model;
  double offset = 0.0;
  for (const RunNumbers& run : hypothesis.runs)
    offset += run.command_offset / static_cast<double>(hypothesis.runs.size());
  if (input_step > 0.0) model.input_hold = std::clamp(offset / input_step, -0.5, 0.5);
  return model;
}

double& at(Hypothesis& hypothesis, const Number& number) {
  const auto index = static_cast<std::size_t>(number.index);
  switch (number.kind) {
    case NumberKind::kBase:
      return hypothesis.model.theta[number.index];
    case NumberKind::kEffect:
      return hypothesis.model.effects[index].theta[static_cast<std::size_t>(number.component)];
    case NumberKind::kWeight:
      return hypothesis.force.weights[index];
    case NumberKind::kCommandOffset:
      return hypothesis.runs[static_cast<std::size_t>(number.run)].command_offset;
    case NumberKind::kWorldForce:
      return hypothesis.runs[static_cast<std::size_t>(number.run)].world_force[number.index];
    default:
      return hypothesis.runs[static_cast<std::size_t>(number.run)].velocity_bias[number.index];
  }
}

double value(const Hypothesis& hypothesis, const Number& number) {
  return at(const_cast<Hypothesis&>(hypothesis), number);  // read only: one list of cases, not two
}

Eigen::VectorXd values(const Hypothesis& hypothesis, const std::vector<Number>& numbers) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(numbers.size()));
  for (Eigen::Index j = 0; j < x.size(); ++j) x[j] = value(hypothesis, numbers[static_cast<std::size_t>(j)]);
  return x;
}

void set_values(Hypothesis& hypothesis, const std::vector<Number>& numbers, const Eigen::VectorXd& values) {
  for (Eigen::Index j = 0; j < values.size(); ++j) at(hypothesis, numbers[static_cast<std::size_t>(j)]) = values[j];
}

double log_prior(const Number& number, double value) {
  const double off = (value - number.mean) / number.sigma;
  const double nu = number.freedom;
  const double constant = std::log(number.sigma);
  if (nu <= 0.0) return -0.5 * off * off - constant - 0.5 * std::log(2.0 * std::numbers::pi);
  return std::lgamma(0.5 * (nu + 1.0)) - std::lgamma(0.5 * nu) - 0.5 * std::log(nu * std::numbers::pi) - constant -
         0.5 * (nu + 1.0) * std::log1p(off * off / nu);
}

double prior_weight(const Number& number, double value) {
  const double off = value - number.mean, square = number.sigma * number.sigma;
  return number.freedom > 0.0 ? (number.freedom + 1.0) / (number.freedom * square + off * off) : 1.0 / square;
}

double log_prior(const std::vector<Number>& numbers, const Eigen::VectorXd& values) {
  double sum = 0.0;
  for (std::size_t j = 0; j < numbers.size(); ++j) sum += log_prior(numbers[j], values[static_cast<Eigen::Index>(j)]);
  return sum;
}

}  // namespace fathom::likelihood
