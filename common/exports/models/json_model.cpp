// All of the model as data: what every other format leaves out stands here.
#include <nlohmann/json.hpp>

#include "common/exports/models/formats.hpp"
#include "common/report/text.hpp"

namespace fathom::exports {

ModelFile to_json(const Craft& craft, const result::Stored& stored) {
  using Json = nlohmann::ordered_json;
  const auto list = [](const auto& values) {
    Json array = Json::array();
    for (const double value : values) array.push_back(value);
    return array;
  };
  const auto numbers = [](const std::vector<NamedValue>& values) {
    Json object = Json::object();
    for (const NamedValue& v : values)
      object[v.name] = {{"value", v.value}, {"std", v.std}, {"unit", v.unit}, {"interval_95", v.range95()}};
    return object;
  };
  Json effects = Json::array();
  for (const EffectFound& effect : stored.result.effects)
    effects.push_back({{"name", effect.name}, {"variant", effect.variant}, {"parameters", numbers(effect.parameters)}});
  for (const StandIn& one : stored.result.stand_ins) {
    if (one.in_model)
      effects.push_back({{"name", one.name}, {"variant", one.variant}, {"parameters", numbers(one.parameters)}});
  }
  Json thrusters = Json::array();
  for (const model::Thruster& t : craft.thrusters)
    thrusters.push_back(
        {{"name", t.name}, {"position", list(t.p_BJ)}, {"axis", list(t.axis_B)}, {"pwm_sign", t.pwm_sign}});
  Json covariance = nullptr;
  if (const std::size_t n = stored.given.covariance_of.size(); n > 0) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < n; ++i)
      rows.push_back(std::vector<double>(stored.given.covariance.begin() + static_cast<std::ptrdiff_t>(i * n),
                                         stored.given.covariance.begin() + static_cast<std::ptrdiff_t>((i + 1) * n)));
    covariance = {{"names", stored.given.covariance_of}, {"matrix", rows}};
  }
  const Json file{{"kind", "model"},
                  {"fathom_version", stored.version},
                  {"vehicle", craft.name},
                  {"frames", "body forward-right-down about Bo, world north-east-down; SI"},
                  {"rigid", {{"mass", craft.mass}, {"inertia", list(craft.inertia)}}},
                  {"added_mass", list(craft.added)},
                  {"linear_drag", list(craft.linear)},
                  {"quadratic_drag", list(craft.quadratic)},
                  {"weight", craft.weight},
                  {"buoyancy", craft.buoyancy},
                  {"centre_of_buoyancy", list(craft.p_BB)},
                  {"water_density", craft.density},
                  {"thrusters", thrusters},
                  {"parameters", numbers(stored.result.parameters_after)},
                  {"covariance", covariance},
                  {"effects", effects},
                  {"notes", craft.notes}};
  return {.extension = "json", .text = file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", .unsaid = {}};
}

}  // namespace fathom::exports
