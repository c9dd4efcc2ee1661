#include "common/excitation/leaving.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "common/model/parameters.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::excitation {
namespace {

std::string words(const char* format, auto... numbers) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, numbers...);
  return text.data();
}

double value_of(const ModelEstimate& model, std::string_view name, double otherwise) {
  const auto found = std::find_if(model.parameters.begin(), model.parameters.end(),
                                  [&](const NamedValue& each) { return each.name == name; });
  return found == model.parameters.end() ? otherwise : found->value;
}

void check_physics(int axis, const ModelEstimate& model, const model::Vehicle& vehicle, const LeavingSettings& s,
                   std::vector<std::string>& missing) {
  const auto parameters = model::base_parameters();
  const auto inertia = static_cast<std::size_t>(axis);
  const std::string inertia_name{model::name(parameters[inertia])};
  const double mass = value_of(model, inertia_name, 0.0);
  const double dry = axis < 3 ? vehicle.mass : vehicle.inertia[axis - 3];
  if (!(mass > 0.0)) {
    missing.push_back(inertia_name + " is not positive");
  } else if (dry > 0.0 && (mass < s.lightest_share * dry || mass > s.heaviest_share * dry)) {
    missing.push_back(words("%s = %.3g does not suit a dry %.3g", inertia_name.c_str(), mass, dry));
  }
  const std::string linear{model::name(parameters[6 + inertia])}, quadratic{model::name(parameters[12 + inertia])};
  const double drag = value_of(model, linear, 0.0) + value_of(model, quadratic, 0.0) * s.ordinary_speed;
  if (!(drag < 0.0)) missing.push_back(linear + " and " + quadratic + " together do not brake");
}

}  // namespace

std::vector<std::string> parameters_of(const Mode& mode, const model::Vehicle& vehicle) {
  std::vector<std::string> names;
  for (const std::string& name : vehicle.parameters) {
    const auto parameter = model::parameter_from_name(name);
    if (parameter && (mode.axis < 0 || model::axis(*parameter) == mode.axis)) names.push_back(name);
  }
  return names;
}

LeavingVerdict may_leave(const Mode& mode, const ModelEstimate& model, const model::Vehicle& vehicle,
                         const LeavingSettings& settings) {
  LeavingVerdict verdict;
  const auto metric = std::find_if(model.modes.begin(), model.modes.end(),
                                   [&](const ModeMetric& each) { return each.mode == mode.name; });
  if (metric == model.modes.end()) {
    verdict.missing.push_back("MODEL says nothing of this mode");
    return verdict;
  }
  verdict.metric = metric->sum;
  verdict.certain = metric->sum < mode.threshold;
  if (!verdict.certain)
    verdict.missing.push_back(words("sum of variances %.3g, needed %.3g", metric->sum, mode.threshold));
  for (int axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[static_cast<std::size_t>(axis)] || (mode.axis >= 0 && axis != mode.axis)) continue;
    const char* letter = model::kAxisNames[static_cast<std::size_t>(axis)];
    const double ratio = model.residual_ratio[axis], mean = model.residual_mean[axis];
    if (ratio <= 0.0) {
      verdict.missing.push_back(words("no residual on %s yet", letter));
    } else if (ratio > settings.largest_ratio) {
      verdict.missing.push_back(words("residual on %s has %.3g times the noise's power", letter, ratio));
    }
    if (std::abs(mean) > settings.largest_mean) {
      verdict.missing.push_back(words("residual on %s is one-sided (%.2g sigma)", letter, mean));
    }
    check_physics(axis, model, vehicle, settings, verdict.missing);
  }
  return verdict;
}

std::string LeavingVerdict::words() const {
  std::string all;
  for (const std::string& part : missing) all += (all.empty() ? "" : "; ") + part;
  return all;
}

}  // namespace fathom::excitation
