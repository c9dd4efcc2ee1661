#include "common/model/learned/features.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::model {
namespace {

double square(double x) { return x * x; }

constexpr std::array<std::string_view, 19> kWords{
    "velocity",      "speed",      "wrench",    "wrench_size",    "thruster",     "thruster_size", "slow_wrench",
    "slow_velocity", "depth_bump", "plan_bump", "heading_cosine", "heading_sine", "after",         "tone_cosine",
    "tone_sine",     "flow_speed", "power_odd", "power_even",     "ramp"};

double factor_value(const Factor& f, const FeatureState& s) {
  const auto bank = static_cast<std::size_t>(f.bank);
  switch (f.quantity) {
    case Quantity::kVelocity:
      return s.nu[f.index];
    case Quantity::kSpeed:
      return std::abs(s.nu[f.index]);
    case Quantity::kWrench:
      return s.tau[f.index];
    case Quantity::kWrenchSize:
      return std::abs(s.tau[f.index]);
    case Quantity::kThruster:
      return s.force[f.index];
    case Quantity::kThrusterSize:
      return std::abs(s.force[f.index]);
    case Quantity::kSlowWrench:
      return s.slow_tau[bank][f.index];
    case Quantity::kSlowVelocity:
      return s.slow_nu[bank][f.index];
    case Quantity::kDepthBump:
      return std::exp(-0.5 * square((s.p_WB.z() - f.a) / f.b));
    case Quantity::kPlanBump:
      return std::exp(-0.5 * (square(s.p_WB.x() - f.a) + square(s.p_WB.y() - f.b)) / square(f.c));
    case Quantity::kHeadingCosine:
      return f.index == 1 ? s.heading_cosine : square(s.heading_cosine) - square(s.heading_sine);
    case Quantity::kHeadingSine:
      return f.index == 1 ? s.heading_sine : 2.0 * s.heading_cosine * s.heading_sine;
    case Quantity::kAfter: {
      const double x = std::clamp((s.t - f.a) / f.b + 0.5, 0.0, 1.0);
      return x * x * (3.0 - 2.0 * x);
    }
    case Quantity::kToneCosine:
      return std::cos(f.a * s.t);
    case Quantity::kToneSine:
      return std::sin(f.a * s.t);
    case Quantity::kFlowSpeed:
      return s.nu.head<3>().norm();
    case Quantity::kPowerOdd:
      return std::copysign(std::pow(std::abs(s.nu[f.index]), f.a), s.nu[f.index]);
    case Quantity::kPowerEven:
      return std::pow(std::abs(s.nu[f.index]), f.a);
    case Quantity::kRamp:
      return (s.t - f.a) / f.b;
  }
  return 0.0;
}

}  // namespace

std::string_view word(Quantity quantity) { return kWords[static_cast<std::size_t>(quantity)]; }

std::optional<Quantity> quantity_from(std::string_view word) {
  const auto found = std::ranges::find(kWords, word);
  if (found == kWords.end()) return std::nullopt;
  return static_cast<Quantity>(found - kWords.begin());
}

double Feature::value(const FeatureState& state) const {
  double product = scale;
  for (int i = 0; i < count; ++i) product *= factor_value(factors[static_cast<std::size_t>(i)], state);
  return product;
}

bool Feature::moves_with_velocity() const {
  return std::any_of(factors.begin(), factors.begin() + count, [](const Factor& f) {
    return f.quantity == Quantity::kVelocity || f.quantity == Quantity::kSpeed || f.quantity == Quantity::kFlowSpeed ||
           f.quantity == Quantity::kPowerOdd || f.quantity == Quantity::kPowerEven;
  });
}

bool Feature::depends_on_time() const {
  return std::any_of(factors.begin(), factors.begin() + count, [](const Factor& f) {
    return f.quantity == Quantity::kAfter || f.quantity == Quantity::kToneCosine || f.quantity == Quantity::kToneSine ||
           f.quantity == Quantity::kRamp;
  });
}

bool Feature::remembers() const {
  return std::any_of(factors.begin(), factors.begin() + count, [](const Factor& f) {
    return f.quantity == Quantity::kSlowWrench || f.quantity == Quantity::kSlowVelocity;
  });
}

void Feature::add(const FeatureState& state, double weight, Vector6d& wrench) const {
  const double size = weight * value(state);
  if (axis < kWorldAxis) {
    wrench[axis] += size;
  } else {
    wrench.head<3>() += size * state.R_WB.row(axis - kWorldAxis).transpose();
  }
}

Vector6d FreeForce::wrench(const FeatureState& state) const {
  Vector6d sum = Vector6d::Zero();
  for (std::size_t j = 0; j < features.size(); ++j) features[j].add(state, weights[j], sum);
  return sum;
}

}  // namespace fathom::model
