#include "common/verdict/why_no_model.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/base/statistics.hpp"
#include "common/preflight/wiring.hpp"
#include "common/verdict/skill.hpp"

namespace fathom::verdict {

void seek_wiring(const model::Vehicle& vehicle, std::span<const Trial> train, DiagnosisResult& result,
                 inference::Conclusion& conclusion) {
  result.wiring = preflight::wiring_fault(vehicle, train, {});
  if (!result.wiring || result.wiring->readings.empty()) return;
  conclusion.verdict = inference::Verdict::no_model;
  conclusion.reasons.push_back(
      {inference::Cause::kWiring, result.wiring->error_reduction, 0.5, result.wiring->readings.front()});
}

void seek_reason(const model::Vehicle& vehicle, std::span<const Trial> train, const inference::Thresholds& thresholds,
                 inference::Conclusion& conclusion) {
  using inference::Cause;
  const std::array<PlainAxis, 6> plain = plain_fit(vehicle, train);
  std::vector<double> ratios;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!plain[axis].known) continue;
    if (plain[axis].t_of_input < thresholds.idle_input)
      conclusion.reasons.push_back(
          {Cause::kInputIdle, plain[axis].t_of_input, thresholds.idle_input, model::kAxisNames[axis]});
    for (const likelihood::Number& number : conclusion.found.base.fit.numbers) {
      if (number.kind == likelihood::NumberKind::kBase && number.index == static_cast<int>(axis) && number.mean > 0.0)
        ratios.push_back(value(conclusion.found.base.fit.hypothesis, number) / number.mean);
    }
  }
  if (ratios.empty()) return;
  const double ratio = median(ratios);
  if (std::max(ratio, 1.0 / std::max(ratio, 1e-9)) > thresholds.foreign_unit)
    conclusion.reasons.push_back({Cause::kForceUnit, ratio, thresholds.foreign_unit, ""});
}

}  // namespace fathom::verdict
