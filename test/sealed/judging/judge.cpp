#include "test/sealed/judging/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace fathom::sealed {
namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

constexpr std::size_t kLargestAliasSet = 3;
constexpr double kConfident = 0.9;
constexpr double kScored = 5.0, kFar = 10.0;  // s, horizons that are compared

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// One accepted effect: its name first, then what it could be instead.
struct Named {
  Names set;
  double probability{};
  const Json* json{};
  [[nodiscard]] bool covers(const std::string& name) const {
    return set.front() == name || (set.size() <= kLargestAliasSet && contains(set, name));
  }
};

std::vector<Named> accepted(const Json& result) {
  std::vector<Named> list;
  for (const Json& effect : result.at("effects")) {
    if (!effect.value("accepted", true)) continue;
    Named one{.set = {effect.at("name")}, .json = &effect};
    for (const Json& other : effect.at("alternatives")) {
      const std::string name = other.is_string() ? other.get<std::string>() : other.at("name").get<std::string>();
      if (!contains(one.set, name)) one.set.push_back(name);
    }
    const Json& odds = effect.at("log_odds");
    one.probability = effect.contains("probability") ? effect.at("probability").get<double>()
                      : odds.is_number()             ? 1.0 / (1.0 + std::exp(-odds.get<double>()))
                                                     : kUnknown;
    list.push_back(std::move(one));
  }
  return list;
}

/// RMSE over standard deviation of the motion, mean over the axes.
double normalised(const Json& error, double horizon = kScored) {
  double sum = 0.0, axes = 0.0;
  for (const Json& row : error.at("prediction")) {
    if (row.at("horizon_s").get<double>() != horizon) continue;
    for (const Json& r2 : row.at("r2")) {
      if (!r2.is_number()) continue;
      sum += std::sqrt(std::max(1.0 - r2.get<double>(), 0.0));
      axes += 1.0;
    }
  }
  return axes > 0.0 ? sum / axes : kUnknown;
}

std::string size_of(const Json& truth) {
  double share = std::numeric_limits<double>::infinity();
  for (const Json& effect : truth.at("effects")) share = std::min(share, effect.at("share").get<double>());
  if (!std::isfinite(share)) return "";
  // Borders are the geometric means between the classes of 5, 15 and 40 %.
  return share < 0.03 ? "faint" : share < 0.0866 ? "weak" : share < 0.245 ? "medium" : "strong";
}

std::string outcome_of(const Score& score, const std::vector<Named>& named) {
  const auto covered = [&](const std::string& name) {
    return std::any_of(named.begin(), named.end(), [&](const Named& n) { return n.covers(name); });
  };
  if (score.kind == "clean" || score.kind == "noise") return named.empty() ? "silent" : "false alarm";
  if (score.kind == "foreign") {
    const bool sure = std::any_of(named.begin(), named.end(),
                                  [](const Named& n) { return n.set.size() == 1 && !(n.probability < kConfident); });
    return named.empty()                    ? "refused"
           : sure                           ? "wrong name"
           : score.verdict == "unexplained" ? "unexplained"
                                            : "hesitant";
  }
  if (named.empty()) return "missed";
  if (score.kind == "many") {
    if (score.strangers > 0) return "wrong";
    return std::ranges::all_of(score.truth, covered) ? "whole" : "part";
  }
  if (score.kind == "pair" || score.kind == "mixed") {
    if (score.kind == "mixed" && score.strangers > 0) return "wrong";
    const auto right = std::count_if(score.truth.begin(), score.truth.end(), covered);
    return right == 2 ? "whole" : right == 1 ? "half" : "wrong";
  }
  const std::string& name = score.truth.front();
  if (named.front().set.front() == name) return "named";
  if (named.front().covers(name)) return "alias";
  return covered(name) ? "later" : "wrong";
}

/// Numbers of effects whose definition here and in the tool is the same: effect, name in result.json (with its form
/// where only the form tells), name in the truth, and what the truth is multiplied by.
struct SameMeaning {
  const char *effect, *found, *truth;
  double factor{1.0};
};
constexpr std::array kSameMeaning{SameMeaning{"current", "v_N", "v_N"},
                                  SameMeaning{"current", "v_E", "v_E"},
                                  SameMeaning{"thruster_lag", "time_constant", "T"},
                                  SameMeaning{"thruster_delay", "delay", "T"},
                                  SameMeaning{"thruster_deadband", "half_width", "d"},
                                  SameMeaning{"thrust_asymmetry", "reverse_change", "a"},
                                  SameMeaning{"thruster_gain", "gain_change", "g"},
                                  SameMeaning{"thruster_failure", "share_lost", "g", -1.0},
                                  SameMeaning{"thruster_failure", "onset", "t_0"},
                                  SameMeaning{"battery_sag", "sensitivity", "k"},
                                  SameMeaning{"cross_coupling", "coefficient", "coefficient"},
                                  SameMeaning{"asymmetric_drag", "coefficient", "c"},
                                  SameMeaning{"cubic_drag", "coefficient", "c_cubic", -1.0},
                                  SameMeaning{"fluid_memory", "time_constant", "T_memory"},
                                  SameMeaning{"restoring_moment", "G_x", "G_x"},
                                  SameMeaning{"restoring_moment", "G_y", "G_y"},
                                  SameMeaning{"restoring_moment", "G_z", "G_z"},
                                  SameMeaning{"centre_of_mass", "x_G", "x_G"},
                                  SameMeaning{"centre_of_mass", "y_G", "y_G"},
                                  SameMeaning{"centre_of_mass", "z_G", "z_G"},
                                  SameMeaning{"compressibility", "weight_per_depth", "N_per_m"},
                                  SameMeaning{"appendage", "attached_x", "x"},
                                  SameMeaning{"appendage", "attached_y", "y"},
                                  SameMeaning{"appendage", "attached_z", "z"},
                                  SameMeaning{"layered_water", "buoyancy_step", "step_N"},
                                  SameMeaning{"layered_water", "edge_depth", "depth"},
                                  SameMeaning{"payload_change", "mass", "mass"},
                                  SameMeaning{"payload_change", "weight", "weight_in_water"},
                                  SameMeaning{"payload_change", "onset", "t_0"},
                                  SameMeaning{"tether_tension", "stiffness", "k"},
                                  SameMeaning{"tether_tension", "slack_length", "L"},
                                  SameMeaning{"tether_tension", "anchor_N", "A_N"},
                                  SameMeaning{"tether_tension", "anchor_E", "A_E"},
                                  SameMeaning{"tether_tension", "anchor_D", "A_D"},
                                  SameMeaning{"wave", "frequency", "frequency_Hz", 2.0 * std::numbers::pi},
                                  SameMeaning{"wind", "W_N", "W_N"},
                                  SameMeaning{"wind", "W_E", "W_E"},
                                  SameMeaning{"steady_force", "F_N", "F_N"},
                                  SameMeaning{"steady_force", "F_E", "F_E"},
                                  SameMeaning{"sensor_latency", "delay", "latency"},
                                  SameMeaning{"sensor_scale", "error", "scale"},
                                  SameMeaning{"lever_arm", "dvl.x", "l_x"},
                                  SameMeaning{"lever_arm", "dvl.y", "l_y"},
                                  SameMeaning{"lever_arm", "dvl.z", "l_z"}};

/// Of a number from the truth: 1.96 is the end of its 95 % interval on that side.
double deviation(const Json& found, double truth) {
  const double value = found.at("value"), away = value - truth;
  const Json range = found.value("interval_95", Json{nullptr, nullptr});
  const Json& end = range.at(away > 0.0 ? 0 : 1);
  const double room = end.is_number() ? std::abs(value - end.get<double>()) : 0.0;
  return room > 0.0 ? 1.96 * away / room : away / found.at("std").get<double>();
}

void compare_parameters(const Json& truth, const Named& named, Score& score) {
  for (const Json& effect : truth.at("effects")) {
    if (effect.at("name") != named.set.front()) continue;
    const std::string form = effect.value("form", ""), found_form = named.json->value("variant", "");
    if (!form.empty() && !found_form.empty() && (" " + found_form + ",").find(" " + form + ",") == std::string::npos) {
      score.wrong_form = true;
      continue;
    }
    for (const auto& item : named.json->at("parameters").items()) {
      const std::string& key = item.key();
      const Json& found = item.value();
      const auto dot = key.find_last_of('.');
      const std::string name = key.substr(dot + 1);  // npos + 1 is 0: no prefix
      if (dot != std::string::npos && !form.empty() && key.substr(0, dot) != form) continue;
      const auto* same = std::find_if(kSameMeaning.begin(), kSameMeaning.end(), [&](const SameMeaning& s) {
        return s.effect == named.set.front() && (s.found == name || s.found == key);
      });
      const Json& value = found.at("value");
      const Json& std = found.at("std");
      if (same == kSameMeaning.end() || !value.is_number() || !std.is_number() || std.get<double>() <= 0.0) continue;
      if (!effect.at("parameters").contains(same->truth)) continue;  // battery_sag by time has other numbers
      const double true_value = same->factor * effect.at("parameters").at(same->truth).get<double>();
      score.deviations.push_back(deviation(found, true_value));
    }
  }
}

void score_correction(const Json& result, Score& score) {
  if (!result.contains("correction") || !result.at("correction").is_object()) return;
  const Json& correction = result.at("correction");
  score.learned = correction.value("adopted", false);
  score.carried = correction.value("carried_to_other_runs", false) || correction.value("stands_in_later_runs", false);
  if (!score.learned) {
    score.correction = correction.value("refused", "");
  } else if (correction.contains("formula")) {
    score.correction = correction.at("formula").value("equation", "");
  } else {
    Names groups;
    for (const Json& term : correction.at("terms")) {
      const std::string group = term.at("group");
      if (!contains(groups, group)) groups.push_back(group);
    }
    for (const std::string& group : groups) score.correction += (score.correction.empty() ? "" : "; ") + group;
  }
}

}  // namespace

Score judge(const Json& truth, const Json& result, const Json& run) {
  Score score;
  score.seed = truth.at("seed");
  score.kind = truth.at("kind");
  score.size = size_of(truth);
  for (const Json& effect : truth.at("effects")) score.truth.push_back(effect.at("name"));
  score.floor = truth.at("floor").at("truth");
  score.base = truth.at("floor").at("base").is_number() ? truth.at("floor").at("base").get<double>() : kUnknown;
  score.seconds = run.value("seconds", kUnknown);
  score.processor = run.value("processor", kUnknown);
  score.megabytes = run.value("megabytes", kUnknown);
  if (result.empty()) {
    score.outcome = "failed";
    return score;
  }
  score.verdict = result.at("verdict");
  std::vector<Named> named = accepted(result);
  // What the craft's own flow does is no effect that was hidden, and no wrong name either.
  const Names nature = truth.value("nature", Names{});
  const std::size_t all = named.size();
  std::erase_if(named, [&](const Named& one) { return contains(nature, one.set.front()); });
  score.of_nature = static_cast<int>(all - named.size());
  if (named.empty() && score.of_nature > 0 && score.verdict == "effect") score.verdict = "adequate";
  for (const Named& one : named) {
    score.found.push_back(one.set.front());
    const bool right = std::any_of(score.truth.begin(), score.truth.end(),
                                   [&](const std::string& name) { return one.covers(name); }) &&
                       score.kind != "foreign" && score.kind != "noise";
    if (!right) ++score.strangers;
    // Stated odds are those of the first name, beside what it may be instead.
    if (std::isfinite(one.probability))
      score.claims.push_back({one.probability, right && contains(score.truth, one.set.front())});
    compare_parameters(truth, one, score);
  }
  score.outcome = outcome_of(score, named);
  const Names wished{"named", "alias", "whole", "silent", "refused", "unexplained"};
  score.good = contains(wished, score.outcome) || (score.kind == "mixed" && score.outcome == "half");
  const std::string first = score.truth.empty() ? "" : score.truth.front();
  for (const Json& finding : result.at("consistency")) {
    const std::string what = finding.at("finding");
    score.in_sensor_check = score.in_sensor_check || (first == "sensor_latency" && what == "delay") ||
                            (first == "sensor_scale" && what == "scale") ||
                            (first == "lever_arm" && what.starts_with("lever_arm"));
  }
  score.before = normalised(result.at("error").at("before"));
  score.after = normalised(result.at("error").at("after"));
  score.before_far = normalised(result.at("error").at("before"), kFar);
  score.after_far = normalised(result.at("error").at("after"), kFar);
  score_correction(result, score);
  score.tilts = truth.at("base").contains("K_p") || truth.at("base").contains("M_q");
  if (truth.contains("bound")) {
    for (const auto& [name, bound] : truth.at("bound").items()) {
      const Json& fitted = result.at("parameters").at("after");
      if (!fitted.contains(name) || !fitted.at(name).at("value").is_number()) continue;
      const double error = fitted.at(name).at("value").get<double>() - truth.at("base").at(name).get<double>();
      score.over_bound.push_back(error / bound.at("speeds").get<double>());
      score.over_all.push_back(error / bound.at("all").get<double>());
    }
  }
  return score;
}

Json to_json(const Score& score) {
  const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json json{{"seed", score.seed},
            {"kind", score.kind},
            {"size", score.size},
            {"truth", score.truth},
            {"found", score.found},
            {"verdict", score.verdict},
            {"outcome", score.outcome},
            {"good", score.good},
            {"strangers", score.strangers},
            {"in_sensor_check", score.in_sensor_check},
            {"before", finite(score.before)},
            {"after", finite(score.after)},
            {"floor", finite(score.floor)},
            {"base", finite(score.base)},
            {"before_10_s", finite(score.before_far)},
            {"after_10_s", finite(score.after_far)},
            {"learned", score.learned},
            {"carried", score.carried},
            {"correction", score.correction},
            {"seconds", finite(score.seconds)},
            {"processor", finite(score.processor)},
            {"megabytes", finite(score.megabytes)},
            {"deviations", score.deviations},
            {"over_bound", score.over_bound},
            {"of_nature", score.of_nature},
            {"tilts", score.tilts},
            {"wrong_form", score.wrong_form}};
  json["claims"] = Json::array();
  for (const Claim& claim : score.claims) json["claims"].push_back({claim.probability, claim.right});
  return json;
}

}  // namespace fathom::sealed
