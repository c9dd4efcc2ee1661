#include "common/model/learned/told.hpp"

#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {

std::optional<Factor> factor_of(const CorrectionFactor& told) {
  const auto quantity = quantity_from(told.quantity);
  if (!quantity) return std::nullopt;
  return Factor{*quantity, told.index, told.bank, told.a, told.b, told.c, told.d, told.column};
}

std::optional<Feature> feature_of(const CorrectionTerm& term) {
  Feature feature{.axis = term.axis, .count = static_cast<int>(term.factors.size()), .scale = term.scale};
  if (term.factors.size() > feature.factors.size()) return std::nullopt;
  for (std::size_t i = 0; i < term.factors.size(); ++i) {
    const auto factor = factor_of(term.factors[i]);
    if (!factor) return std::nullopt;
    feature.factors[i] = *factor;
  }
  return feature;
}

std::string where(const CorrectionTerm& term) {
  const auto feature = feature_of(term);
  for (int i = 0; term.law && feature && i < feature->count; ++i) {
    const Factor& factor = feature->factors[static_cast<std::size_t>(i)];
    if (kind_of(factor.quantity).where != nullptr) return kind_of(factor.quantity).where(factor);
  }
  return "";
}

}  // namespace fathom::model
