#include "common/model/learned/features.hpp"

#include <algorithm>

#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

constexpr std::array kKinds{
#define FACTOR(enumerator, name) &factor_##name,
#include "common/model/learned/factors/factors.def"
#undef FACTOR
};

template <typename Is>
bool any(const Feature& feature, const Is& is) {
  return std::any_of(feature.factors.begin(), feature.factors.begin() + feature.count,
                     [&](const Factor& f) { return is(kind_of(f.quantity)); });
}

}  // namespace

const FactorKind& kind_of(Quantity quantity) { return *kKinds[static_cast<std::size_t>(quantity)]; }

std::string_view word(Quantity quantity) { return kind_of(quantity).word; }

std::optional<Quantity> quantity_from(std::string_view word) {
  const auto found = std::ranges::find(kKinds, word, &FactorKind::word);
  if (found == kKinds.end()) return std::nullopt;
  return static_cast<Quantity>(found - kKinds.begin());
}

std::string direction_words(int axis) {
  if (axis < kWorldAxis) return kTauNames[axis];
  if (axis < kHullDrag) return std::array{"north", "east", "down"}[static_cast<std::size_t>(axis - kWorldAxis)];
  if (axis == kHullDrag) return "the hull's drag";
  if (axis == kAllThrust) return "the thrust";
  return "thruster " + std::to_string(axis - kThrusterLine + 1);
}

std::string direction_symbol(int axis) {
  if (axis < kWorldAxis) return std::string{"tau_"} + kTauNames[axis] + " =";
  if (axis < kHullDrag) return "f_" + direction_words(axis) + " =";
  if (axis == kHullDrag) return "tau = -D(nu) nu";
  if (axis == kAllThrust) return "tau = B f";
  return "tau = b_" + std::to_string(axis - kThrusterLine + 1);
}

std::string Feature::words() const {
  std::string product;
  for (int i = 0; i < count; ++i) {
    const Factor& factor = factors[static_cast<std::size_t>(i)];
    product += (product.empty() ? "" : " ") + kind_of(factor.quantity).words(factor);
  }
  return product;
}

double Feature::value(const FeatureState& state) const {
  double product = scale;
  for (int i = 0; i < count; ++i) {
    const Factor& factor = factors[static_cast<std::size_t>(i)];
    product *= kind_of(factor.quantity).value(factor, state);
  }
  return product;
}

bool Feature::moves_with_velocity() const {
  return axis == kHullDrag || any(*this, [](const FactorKind& kind) { return kind.moves; });
}

bool Feature::depends_on_time() const {
  return any(*this, [](const FactorKind& kind) { return kind.in_time; });
}

bool Feature::remembers() const {
  return any(*this, [](const FactorKind& kind) { return kind.banks > 0; });
}

void Feature::add(const FeatureState& state, double weight, Vector6d& wrench) const {
  const double size = weight * value(state);
  if (axis < kWorldAxis) {
    wrench[axis] += size;
  } else if (axis < kHullDrag) {
    wrench.head<3>() += size * state.R_WB.row(axis - kWorldAxis).transpose();
  } else if (axis == kHullDrag) {
    wrench += size * state.drag;
  } else if (axis == kAllThrust) {
    wrench += size * state.tau;
  } else if (state.allocation != nullptr && axis - kThrusterLine < state.allocation->cols()) {
    wrench += size * state.allocation->col(axis - kThrusterLine);
  }
}

Vector6d FreeForce::wrench(const FeatureState& state) const {
  Vector6d sum = Vector6d::Zero();
  for (std::size_t j = 0; j < features.size(); ++j) features[j].add(state, weights[j], sum);
  return sum;
}

bool FreeForce::reads_drag() const {
  return std::ranges::any_of(features, [](const Feature& feature) { return feature.axis == kHullDrag; });
}

}  // namespace fathom::model
