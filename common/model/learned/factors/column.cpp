// A measured column, about its mean: (x - a) / b, with b its spread; its recording has been within c of the mean. Where
// it was not measured the factor is 0, and with it all that it multiplies.
#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

double column(const Factor& f, const FeatureState& s) {
  const std::size_t at = 2 * static_cast<std::size_t>(f.index);
  return at < s.columns.size() ? s.columns[at] : f.a;
}

}  // namespace

constinit const FactorKind factor_column{
    .word = "column",
    .sentence = "a measured column, about its mean",
    .unit = "1",
    .indexed = Indexed::kColumns,
    .value = [](const Factor& f, const FeatureState& s) { return (column(f, s) - f.a) / f.b; },
    .words =
        [](const Factor& f) {
          return "(" + f.column + (f.a < 0.0 ? " + " : " - ") + brief_number(std::abs(f.a)) + ") / " +
                 brief_number(f.b);
        },
    .within = [](const Factor& f, const FeatureState& s,
                 const Visited&) { return fade_beyond(column(f, s) - f.a, f.c); }};

}  // namespace fathom::model
