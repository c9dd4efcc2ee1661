#include "common/model/learned/told.hpp"

#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {

std::optional<Feature> feature_of(const CorrectionTerm& term) {
  Feature feature{.axis = term.axis, .count = static_cast<int>(term.factors.size()), .scale = term.scale};
  if (term.factors.size() > feature.factors.size()) return std::nullopt;
  for (std::size_t i = 0; i < term.factors.size(); ++i) {
    const CorrectionFactor& f = term.factors[i];
    const auto quantity = quantity_from(f.quantity);
    if (!quantity) return std::nullopt;
    feature.factors[i] = {*quantity, f.index, f.bank, f.a, f.b, f.c, f.d, f.column};
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
