#include "common/model/learned/learned_file.hpp"

#include <cstdio>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/learned/factors/factor_kind.hpp"
#include "common/model/parameters.hpp"

namespace fathom::model {
namespace {

std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

Factor factor_of(const Config& config) {
  const std::string name = config.text("quantity");
  const auto quantity = quantity_from(name);
  if (!quantity) config.fail("quantity", "no feature reads '" + name + "'");
  Factor factor{.quantity = *quantity, .index = config.integer("index"), .bank = config.integer("bank")};
  factor.a = config.quantity("a", "");
  factor.b = config.quantity("b", "");
  factor.c = config.quantity("c", "");
  if (config.has("d")) factor.d = config.quantity("d", "");
  if (config.has("column")) factor.column = config.text("column");
  const FactorKind& kind = kind_of(*quantity);
  if (kind.banks > 0 && (factor.bank < 0 || factor.bank >= kind.banks))
    config.fail("bank", "there is no such low pass");
  const bool of_six = kind.indexed != Indexed::kThrusters && kind.indexed != Indexed::kColumns;
  if (factor.index < 0 || (of_six && factor.index >= 6) || factor.index >= kMaxActuators)
    config.fail("index", "there is no such axis or thruster");
  if (kind.rate == nullptr && !kind.of_point && (factor.b == 0.0 || factor.c == 0.0))
    config.fail("b", "a width is not 0");
  return factor;
}

Vector6d six(const Config& config, const std::string& key) {
  const std::vector<double> values = config.quantities(key, "");
  if (values.size() != 6) config.fail(key, "'" + key + "' must be six numbers");
  return Eigen::Map<const Vector6d>{values.data()};
}

std::shared_ptr<const LearnedForce> force_of(const Config& config, const Vehicle& vehicle) {
  FreeForce force;
  for (const Config& term : config.list("terms")) {
    const std::vector<Config> factors = term.list("factors");
    Feature feature{.axis = term.integer("axis"), .count = static_cast<int>(factors.size())};
    if (feature.axis < 0 || feature.axis >= kDirections)
      term.fail("axis", "'axis' must be from 0 to " + std::to_string(kDirections - 1));
    if (factors.size() > feature.factors.size())
      term.fail("factors", "a term has " + std::to_string(feature.factors.size()) + " factors at most");
    for (std::size_t i = 0; i < factors.size(); ++i) feature.factors[i] = factor_of(factors[i]);
    feature.scale = term.quantity("scale", "");
    const std::string kind = term.text("group");
    const auto at = static_cast<int>(force.features.size());
    if (force.groups.empty() || force.groups.back().kind != kind || force.groups.back().axis != feature.axis)
      force.groups.push_back(
          {.kind = kind, .axis = feature.axis, .first = at, .closed = term.has("law") && term.flag("law")});
    ++force.groups.back().count;
    force.features.push_back(feature);
    force.weights.push_back(term.quantity("weight", ""));
  }
  const Config seen = config.section("visited");
  Visited visited{.nu = six(seen, "nu"), .tau = six(seen, "tau")};
  const std::vector<double> forces = seen.quantities("force", "");
  const auto count = vehicle.allocation.cols();
  if (config.flag("input_is_wrench")) {  // no term reads a single thruster
    visited.force.setZero(count);
  } else {
    if (static_cast<Eigen::Index>(forces.size()) != count)
      seen.fail("force", "learned with " + std::to_string(forces.size()) + " thrusters; " + vehicle.name + " has " +
                             std::to_string(count));
    visited.force = Eigen::Map<const Eigen::VectorXd>{forces.data(), count};
  }
  visited.p_low = seen.vector3("p_low", "");
  visited.p_high = seen.vector3("p_high", "");
  for (const Feature& feature : force.features) {
    if (feature.axis < kEachThruster && feature.axis - kThrusterLine >= vehicle.allocation.cols())
      config.fail("terms", "a term acts along a thruster that " + vehicle.name + " does not have");
    for (int i = 0; i < feature.count; ++i) {
      const Factor& factor = feature.factors[static_cast<std::size_t>(i)];
      const bool thruster = kind_of(factor.quantity).indexed == Indexed::kThrusters;
      if (thruster && factor.index >= visited.force.size())
        config.fail("terms", "a term reads a thruster that " + vehicle.name + " does not have");
    }
  }
  FreeForce lasting = lasting_of(force);
  if (lasting.empty()) return nullptr;
  return std::make_shared<const LearnedForce>(std::move(lasting), std::move(visited), vehicle.allocation);
}

}  // namespace

LearnedModel read_learned(const std::string& path, const Vehicle& vehicle) {
  const Config file = Config::load(path);
  if (!file.has("parameters") || !file.has("fathom_version"))
    throw InputError(path + ": no result.json of fathom diagnose");
  if (file.text("vehicle") != vehicle.name)
    file.fail("vehicle", "this is a model of " + file.text("vehicle") + ", not of " + vehicle.name);
  LearnedModel model;
  const Config after = file.section("parameters").section("after");
  for (const std::string& name : after.keys()) {
    if (!parameter_from_name(name)) continue;
    model.parameters.emplace_back(name, after.section(name).quantity("value", ""));
  }
  if (model.parameters.empty())
    file.fail("parameters", "no numbers are told: the model did not follow its thrust, or was not judged");
  for (const Config& effect : file.list("effects")) {
    if (!effect.flag("accepted") || effect.text("name").starts_with("column ")) continue;  // nobody measures it there
    std::string text = effect.text("name") + "=";
    if (const std::string variant = effect.text("variant"); !variant.empty()) text += "variant:" + variant + ",";
    const Config numbers = effect.section("parameters");
    for (const std::string& name : numbers.keys())
      text += name + ":" + digits(numbers.section(name).quantity("value", "")) + ",";
    text.pop_back();
    model.effects.push_back(std::move(text));
  }
  if (file.has("correction") && file.section("correction").flag("carried_to_other_runs"))
    model.force = force_of(file.section("correction"), vehicle);
  return model;
}

}  // namespace fathom::model
