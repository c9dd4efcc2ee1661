#include "common/preflight/sensor_faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/model/effect.hpp"

namespace fathom::preflight {
namespace {

constexpr double kMostOdds = 200.0;    // log odds beyond which more evidence says nothing to anybody
constexpr double kFindingsTried = 40;  // numbers that the sensor check looks at

constexpr double kSame = 3.0;  // standard deviations by which two delays may differ

/// The effect that a finding amounts to, and its number as that effect states it.
struct Fault {
  std::string effect;
  std::string signal, reference;
  NamedValue number;
  double deviations{};  ///< from no fault
  double freedom{};     ///< degrees of freedom of the number's standard deviation
};

/// Log-likelihood ratio of the number against no fault: Student's, for a few blocks of data know their scatter badly.
double log_likelihood_ratio(const Fault& fault) {
  const double square = fault.deviations * fault.deviations;
  return fault.freedom > 0.0 ? 0.5 * (fault.freedom + 1.0) * std::log1p(square / fault.freedom) : 0.5 * square;
}

std::optional<Fault> fault_of(const ConsistencyFinding& finding) {
  if (finding.run != "all" || finding.std <= 0.0 || !finding.action.starts_with("corrected")) return std::nullopt;
  const auto fault = [&](const char* effect, const std::string& number, double value, double std) {
    return Fault{effect,
                 finding.signal,
                 finding.reference,
                 {finding.signal + "." + number, value, std, finding.unit},
                 std::abs(value) / std,
                 finding.freedom};
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

/// Nothing is measured before it happens: what seems early is right, and its reference late. The others are then
/// counted from the earliest.
void charge_the_late(std::vector<Fault>& faults) {
  const auto is_delay = [](const Fault& f) { return f.effect == "sensor_latency"; };
  std::optional<Fault> earliest;
  for (const Fault& f : faults) {
    if (is_delay(f) && (!earliest || f.number.value < earliest->number.value)) earliest = f;
  }
  if (!earliest || earliest->number.value >= 0.0) return;
  for (Fault& f : faults) {
    if (!is_delay(f) || f.reference != earliest->reference || f.signal == earliest->signal) continue;
    f.number.value -= earliest->number.value;
    f.number.std = std::hypot(f.number.std, earliest->number.std);
    f.deviations = std::abs(f.number.value) / f.number.std;
  }
  std::erase_if(faults, [&](const Fault& f) {
    return is_delay(f) && f.reference == earliest->reference && (f.signal == earliest->signal || f.deviations < kSame);
  });
  faults.push_back(
      {earliest->effect,
       earliest->reference,
       earliest->signal,
       {earliest->reference + ".delay", -earliest->number.value, earliest->number.std, earliest->number.unit},
       earliest->deviations,
       earliest->freedom});
}

}  // namespace

std::vector<EffectFound> sensor_faults(std::span<const ConsistencyFinding> findings) {
  std::vector<Fault> faults;
  for (const ConsistencyFinding& finding : findings) {
    if (const std::optional<Fault> fault = fault_of(finding)) faults.push_back(*fault);
  }
  charge_the_late(faults);
  std::vector<EffectFound> found;
  for (const Fault& fault : faults) {
    const double odds = std::min(log_likelihood_ratio(fault), kMostOdds) - std::log(kFindingsTried);
    auto place = std::find_if(found.begin(), found.end(), [&](const auto& e) { return e.name == fault.effect; });
    if (place == found.end()) {
      const model::Effect* effect = model::find_effect(fault.effect);
      found.push_back({.name = fault.effect,
                       .variant = fault.signal,
                       .log_odds = odds,
                       .probability = 1.0 / (1.0 + std::exp(-odds)),
                       .sentence = effect != nullptr ? std::string(effect->sentence()) : ""});
      place = found.end() - 1;
    } else if (place->variant.find(fault.signal) == std::string::npos) {
      place->variant += ", " + fault.signal;
    }
    place->log_odds = std::max(place->log_odds, odds);
    place->probability = 1.0 / (1.0 + std::exp(-place->log_odds));
    place->parameters.push_back(fault.number);
  }
  return found;
}

bool thrust_as_late_as_gyro(const DiagnosisResult& result, std::span<const ConsistencyFinding> findings) {
  const auto pooled = [&](const char* signal, const char* what) {
    return std::ranges::find_if(findings, [&](const ConsistencyFinding& f) {
      return f.run == "all" && f.signal == signal && f.finding == what;
    });
  };
  const auto gyro = pooled("gyro", "delay"), clock = pooled("thrusters", "clock");
  if (gyro == findings.end() || gyro->size <= 0.0 || clock == findings.end() || clock->reference != "gyro")
    return false;
  return std::ranges::any_of(result.effects, [&](const EffectFound& effect) {
    return effect.accepted && effect.name == "thruster_delay" &&
           std::ranges::any_of(effect.parameters, [&](const NamedValue& number) {
             return number.name == "delay" &&
                    std::abs(number.value - gyro->size) < kSame * std::hypot(number.std, gyro->std);
           });
  });
}

}  // namespace fathom::preflight
