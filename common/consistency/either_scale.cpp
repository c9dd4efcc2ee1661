#include "common/consistency/either_scale.hpp"

#include <algorithm>

namespace fathom::consistency {
namespace {

ConsistencyFinding* finding_of(ConsistencyResult& result) {
  const auto found =
      std::ranges::find_if(result.findings, [](const ConsistencyFinding& one) { return !one.or_else.empty(); });
  return found == result.findings.end() ? nullptr : &*found;
}

}  // namespace

void put_scale_on_velocity_log(ConsistencyResult& result) {
  if (!result.either_scale) return;
  for (Corrections& one : result.corrections) {
    one.position_scale *= *result.either_scale;
    one.dvl.scale *= *result.either_scale;
  }
  ConsistencyFinding* finding = finding_of(result);
  if (finding == nullptr) return;
  std::swap(finding->signal, finding->or_else);
  finding->reference = finding->or_else;
  finding->action = "corrected: the velocity log is multiplied by the size";
}

void say_of_scale(ConsistencyResult& result, const std::string& why) {
  if (ConsistencyFinding* finding = finding_of(result)) finding->evidence += "; " + why;
}

}  // namespace fathom::consistency
