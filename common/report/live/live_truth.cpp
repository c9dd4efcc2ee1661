// The only reader of what the simulator knows: the last section of a live trial's page.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/report/live/live_trial.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr double kSettle = 5.0;     // s at the start in which the filters find their place
constexpr Utime kTogether = 5'000;  // us between a truth and the state that answers it

std::string effect_text(const nlohmann::json& effect) {
  std::string text = effect_title(effect.value("name", ""), effect.value("variant", ""));
  if (!effect.contains("parameters")) return text;
  std::vector<std::string> parts;
  for (const auto& [name, entry] : effect["parameters"].items()) {
    const std::string unit = entry.value("unit", "");
    parts.push_back(name + " " + number(entry.value("value", 0.0)) + (unit.empty() ? "" : " " + unit));
  }
  return text + ": " + join(parts, ", ");
}

// Errors of STATE, moved to the truth's own instant by the true motion.
void compare_states(const Recording& recording, TruthComparison& comparison) {
  if (recording.truth.empty() || recording.state.empty()) return;
  const Utime begin = trial_origin(recording);
  std::array<double, 6> square{}, normalised{};
  auto at = recording.state.begin();
  for (const Truth& truth : recording.truth) {
    while (at != recording.state.end() && at->utime < truth.utime) ++at;
    if (at == recording.state.end()) break;
    if (at->utime - truth.utime > kTogether || !at->valid || seconds_between(begin, truth.utime) < kSettle) continue;
    const double dt = seconds_between(truth.utime, at->utime);
    const Eigen::Vector3d dp = at->p_WB - truth.p_WB - dt * (truth.q_WB * truth.nu.head<3>());
    const Eigen::Vector3d dv = at->nu.head<3>() - truth.nu.head<3>() - dt * truth.nu_dot.head<3>();
    ++comparison.compared;
    for (Eigen::Index k = 0; k < 6; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double error = k < 3 ? dp[k] : dv[k - 3];
      const double sigma = at->sigma[k < 3 ? k : k + 3];
      square[i] += error * error;
      comparison.state_worst[i] = std::max(comparison.state_worst[i], std::abs(error));
      if (sigma > 0.0) normalised[i] += error * error / (sigma * sigma);
    }
  }
  const auto n = static_cast<double>(std::max<std::size_t>(comparison.compared, 1));
  for (std::size_t i = 0; i < 6; ++i) {
    comparison.state_rms[i] = std::sqrt(square[i] / n);
    comparison.state_normalised[i] = normalised[i] / n;
  }
}

}  // namespace

TruthComparison compare_truth(const std::string& path, const Recording& recording) {
  std::ifstream file{path};
  if (!file) throw InputError(path + ": cannot be read; the simulator writes it with --out-dir");
  TruthComparison comparison;
  try {
    const nlohmann::json truth = nlohmann::json::parse(file);
    for (const auto& [name, entry] : truth.at("parameters").items()) {
      comparison.parameters[name] = entry.at("value").get<double>();
    }
    for (const auto& effect : truth.at("effects")) {
      comparison.effects.push_back(effect_text(effect));
      comparison.effect_names.push_back(effect.at("name").get<std::string>());
    }
    const auto& contacts = truth.at("contacts");
    comparison.contacts = {contacts.at("walls").get<int>(), contacts.at("floor").get<int>(),
                           contacts.at("surface").get<int>()};
  } catch (const nlohmann::json::exception& error) {
    throw InputError(path + ": not a simulator's truth.json: " + error.what());
  }
  compare_states(recording, comparison);
  return comparison;
}

}  // namespace fathom::report
