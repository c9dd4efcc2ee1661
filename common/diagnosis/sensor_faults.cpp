#include "common/diagnosis/sensor_faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/model/effect.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kMostOdds = 200.0;    // log odds beyond which more evidence says nothing to anybody
constexpr double kFindingsTried = 40;  // numbers that the sensor check looks at

/// The effect that a finding amounts to, and its number as that effect states it.
struct Fault {
  std::string effect;
  NamedValue number;
  double deviations{};  ///< from no fault
};

std::optional<Fault> fault_of(const ConsistencyFinding& finding) {
  if (finding.run != "all" || finding.std <= 0.0 || !finding.action.starts_with("corrected")) return std::nullopt;
  const auto fault = [&](const char* effect, const std::string& number, double value, double std) {
    return Fault{effect, {finding.signal + "." + number, value, std, finding.unit}, std::abs(value) / std};
  };
  if (finding.finding == "delay") return fault("sensor_latency", "delay", finding.size, finding.std);
  if (finding.finding == "scale") {
    // The finding multiplies the logged signal; the fault is what the sensor makes of the true one.
    return fault("sensor_scale", "error", 1.0 / finding.size - 1.0, finding.std / (finding.size * finding.size));
  }
  if (finding.finding.starts_with("lever_arm_"))
    return fault("lever_arm", finding.finding.substr(10), finding.size, finding.std);
  return std::nullopt;
}

std::string listed(const std::vector<EffectFound>& effects) {
  std::string text;
  for (std::size_t i = 0; i < effects.size(); ++i) text += (i > 0 ? ", " : "") + effects[i].name;
  return text;
}

}  // namespace

void adopt_sensor_faults(DiagnosisResult& result) {
  std::vector<EffectFound> found;
  for (const ConsistencyFinding& finding : result.consistency) {
    const std::optional<Fault> fault = fault_of(finding);
    if (!fault) continue;
    const double odds = std::min(0.5 * fault->deviations * fault->deviations, kMostOdds) - std::log(kFindingsTried);
    auto place = std::find_if(found.begin(), found.end(), [&](const auto& e) { return e.name == fault->effect; });
    if (place == found.end()) {
      const model::Effect* effect = model::find_effect(fault->effect);
      found.push_back({.name = fault->effect,
                       .variant = finding.signal,
                       .log_odds = odds,
                       .sentence = effect != nullptr ? std::string(effect->sentence()) : ""});
      place = found.end() - 1;
    } else if (place->variant.find(finding.signal) == std::string::npos) {
      place->variant += ", " + finding.signal;
    }
    place->log_odds = std::max(place->log_odds, odds);
    place->parameters.push_back(fault->number);
  }
  if (found.empty()) return;
  result.paragraph = "The sensors contradict each other (" + listed(found) +
                     "); that is corrected in everything that follows. " + result.paragraph;
  if (result.verdict == "adequate") result.verdict = "effect";
  for (auto effect = found.rbegin(); effect != found.rend(); ++effect) {
    std::erase_if(result.candidates, [&](const CandidateTried& c) { return c.name == effect->name; });
    result.candidates.insert(
        result.candidates.begin(),
        {effect->name, effect->variant, effect->log_odds, 0.0, {}, "accepted: found by comparing the sensors"});
  }
  result.effects.insert(result.effects.begin(), found.begin(), found.end());
}

}  // namespace fathom::diagnosis
