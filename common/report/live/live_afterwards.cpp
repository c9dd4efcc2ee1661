// The closing of the loop on a live trial's own log: what `fathom diagnose` found afterwards, in the trial's report.
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/report/live/live_trial.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/style.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr double kHorizon = 5.0;  // s

/// By name of the velocity, at that horizon.
std::map<std::string, double> errors_of(const nlohmann::json& side) {
  std::map<std::string, double> errors;
  for (const auto& each : side.at("prediction")) {
    if (each.at("horizon_s").get<double>() != kHorizon) continue;
    for (const auto& [velocity, rmse] : each.at("rmse").items()) {
      if (rmse.is_number()) errors[velocity] = rmse.get<double>();
    }
  }
  return errors;
}

}  // namespace

Afterwards read_afterwards(const std::string& folder, const std::string& page) {
  const std::string path = folder + "/result.json";
  std::ifstream file{path};
  if (!file) throw InputError(path + ": cannot be read; fathom diagnose --out writes it");
  Afterwards found{.page = page};
  try {
    const nlohmann::json result = nlohmann::json::parse(file);
    found.verdict = result.at("verdict").get<std::string>();
    for (const auto& effect : result.at("effects")) {
      found.effects.push_back({.name = effect.at("name").get<std::string>(),
                               .log_odds = effect.at("log_odds").is_number()
                                               ? effect.at("log_odds").get<double>()
                                               : std::numeric_limits<double>::quiet_NaN()});
    }
    found.before = errors_of(result.at("error").at("before"));
    found.after = errors_of(result.at("error").at("after"));
    const auto& improvement = result.at("error").at("improvement").at("value");
    if (improvement.is_number()) found.improvement = improvement.get<double>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(path + ": not a diagnosis of fathom diagnose: " + error.what());
  }
  return found;
}

std::string afterwards_section(const Afterwards& found) {
  std::string html =
      "<section><h2>The loop closed on the log</h2><p>Verdict on the whole log, the last 30 % of which "
      "no fit has seen: <b>" +
      escape(found.verdict) + "</b>";
  if (!found.page.empty()) html += ". Evidence and pictures: <a href=\"" + escape(found.page) + "\">the diagnosis</a>";
  html += ".</p>";
  if (!found.effects.empty()) {
    html += "<table>" + heading_cells({"Effect", "Log odds"}, {1});
    for (const EffectEvidence& one : found.effects) {
      html += "<tr>" + cell(escape(effect_title(one.name)), "k") + cell(number(one.log_odds), "n") + "</tr>\n";
    }
    html += "</table>\n";
  }
  if (!found.before.empty()) {
    html +=
        "<table>" + heading_cells({"Error of predictions over 5 s (RMS)", "Base model", "With what was found"}, {1, 2});
    for (const auto& [velocity, error] : found.before) {
      const auto after = found.after.find(velocity);
      const bool turns = velocity == "p" || velocity == "q" || velocity == "r";
      const std::string unit = turns ? " rad/s" : " m/s";
      html += "<tr>" + cell(escape(velocity), "k") + cell(number(error, 3) + unit, "n") +
              cell(after == found.after.end() ? "-" : number(after->second, 3) + unit, "n") + "</tr>\n";
    }
    html += "</table>\n";
  }
  return html + "</section>\n";
}

}  // namespace fathom::report
