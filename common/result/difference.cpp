#include <algorithm>
#include <cmath>
#include <map>

#include "common/result/explain.hpp"
#include "common/result/lines.hpp"

namespace fathom::result {
namespace {

using report::number;

constexpr double kFalseAlarm = 0.05;  // chance that anything is called different where nothing is, over all numbers

struct Change {
  std::string name;
  NamedValue first, second;
  double z{};    // of the difference, in its own standard deviations
  bool known{};  // whether they have any
};

/// Parameters and the effects' numbers under one name each.
std::map<std::string, NamedValue> numbers_of(const DiagnosisResult& result) {
  std::map<std::string, NamedValue> all;
  for (const NamedValue& value : result.parameters_after) all[value.name] = value;
  for (const EffectFound& effect : result.effects) {
    for (const NamedValue& value : effect.parameters) all[effect.name + "." + value.name] = value;
  }
  return all;
}

/// Two-sided p-value of a standard normal number.
double p_value(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

std::vector<Change> changes(const DiagnosisResult& first, const DiagnosisResult& second) {
  std::vector<Change> both;
  const auto before = numbers_of(first), after = numbers_of(second);
  for (const auto& [name, value] : before) {
    const auto other = after.find(name);
    if (other == after.end() || other->second.unit != value.unit) continue;
    const double sigma = std::hypot(value.std, other->second.std);
    const bool known = std::isfinite(sigma) && sigma > 0.0;
    both.push_back({name, value, other->second, known ? (other->second.value - value.value) / sigma : 0.0, known});
  }
  std::ranges::stable_sort(both, std::greater{}, [](const Change& c) { return std::abs(c.z); });
  return both;
}

std::string from_to(const Change& change) {
  const double size = std::abs(change.first.value);
  std::string text =
      change.name + ": " + report::with_interval(change.first) + " -> " + report::with_interval(change.second);
  if (size > 0.0) {
    const double share = (change.second.value - change.first.value) / size;
    text += " (" + std::string{share >= 0.0 ? "+" : ""} + report::percent(share) + ", " +
            number(std::abs(change.z), 2) + " standard deviations)";
  }
  return text;
}

const EffectFound* find(const DiagnosisResult& result, const std::string& name) {
  const auto found = std::ranges::find(result.effects, name, &EffectFound::name);
  return found == result.effects.end() ? nullptr : &*found;
}

std::string error_of(const DiagnosisResult& result) {
  for (const PredictionError& p : result.error_after.prediction) {
    if (p.horizon_s != 5.0) continue;
    std::string text;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!std::isfinite(p.rmse[axis])) continue;
      const report::Axis& a = report::kAxes[axis];
      text +=
          (text.empty() ? "" : ", ") + std::string{a.velocity} + " " + number(a.scale * p.rmse[axis]) + " " + a.unit;
    }
    return text;
  }
  return "not judged";
}

void same_data(Lines& out, const Stored& first, const Stored& second) {
  if (first.result.vehicle != second.result.vehicle)
    out.line("These are different vehicles: " + first.result.vehicle + " and " + second.result.vehicle + ".", "  ! ");
  for (const OriginFile& a : first.origin.files) {
    for (const OriginFile& b : second.origin.files) {
      if (a.role == "vehicle" && b.role == "vehicle" && a.sha256 != b.sha256)
        out.line("The vehicle files differ: " + a.path + ", " + b.path + ".", "  ! ");
      if (!a.run.empty() && a.sha256 == b.sha256)
        out.line("Both rest on " + a.path + (a.path == b.path ? "" : " (" + b.path + ")") + ".", "  · ");
    }
  }
}

}  // namespace

std::string difference(const Stored& first, const Stored& second) {
  const DiagnosisResult &a = first.result, &b = second.result;
  Lines out;
  out.title("A  " + first.path + ": " + a.vehicle + ", " + a.verdict);
  out.line("B  " + second.path + ": " + b.vehicle + ", " + b.verdict, "", 0);
  same_data(out, first, second);

  out.title("Effects");
  bool any = false;
  for (const EffectFound& effect : a.effects) {
    any = true;
    if (const EffectFound* still = find(b, effect.name)) {
      out.line(report::effect_title(effect.name, still->variant) + ": in both" +
                   (still->variant == effect.variant ? "" : ", in A as " + effect.variant),
               "  = ");
    } else {
      const auto asked = std::ranges::find(b.candidates, effect.name, &CandidateTried::name);
      out.line(report::effect_title(effect.name, effect.variant) + ": gone in B" +
                   (asked == b.candidates.end() ? "" : " (" + asked->reason + ")"),
               "  - ");
    }
  }
  for (const EffectFound& effect : b.effects) {
    if (find(a, effect.name) != nullptr) continue;
    any = true;
    out.line(report::effect_title(effect.name, effect.variant) +
                 ": new in B, it is this cause: " + report::percent(effect.probability),
             "  + ");
  }
  if (!any) out.line("none in either");

  const std::vector<Change> all = changes(a, b);
  out.title("Numbers that differ (chance of a false alarm anywhere: " + report::percent(kFalseAlarm) + ")");
  std::size_t differ = 0;
  for (const Change& change : all) {
    if (p_value(change.z) > kFalseAlarm / static_cast<double>(all.size())) break;  // Bonferroni
    out.line(from_to(change), "  · ");
    ++differ;
  }
  if (differ == 0) out.line("none");
  const auto complete = [](const DiagnosisResult& one) { return one.verdict == "adequate" || one.verdict == "effect"; };
  if (differ > 0 && !(complete(a) && complete(b)))
    out.line("intervals hold only if the model does, and something is unexplained: small differences prove nothing");
  const auto open = static_cast<std::size_t>(std::ranges::count(all, false, &Change::known));
  if (differ + open < all.size())
    out.line(std::to_string(all.size() - differ - open) + " others agree within their uncertainty");
  if (open > 0) out.line(std::to_string(open) + " cannot be compared: no uncertainty is told of them");

  out.title("Prediction error 5 s ahead");
  out.line(error_of(a), "  A ");
  out.line(error_of(b), "  B ");
  return out.text();
}

}  // namespace fathom::result
