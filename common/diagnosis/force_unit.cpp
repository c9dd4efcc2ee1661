#include "common/diagnosis/force_unit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/base/statistics.hpp"
#include "common/model/parameters.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kNewtonsInKgf = 9.80665;
constexpr double kFar = 5.0;    // added mass and a rough guess of a hull's inertia are within less
constexpr double kAlike = 1.7;  // of a unit's factor: as well as a vehicle file knows its masses

struct Unit {
  double factor;
  const char* words;
};

}  // namespace

std::optional<ConsistencyFinding> compare_inertia(const model::Vehicle& vehicle,
                                                  std::span<const NamedValue> parameters) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    const auto parameter = model::parameter_from_name(vehicle.parameters[i]);
    if (!parameter || model::sign_constraint(*parameter) <= 0 || !(vehicle.priors[i].mean > 0.0)) continue;
    const auto fitted = std::ranges::find(parameters, vehicle.parameters[i], &NamedValue::name);
    if (fitted != parameters.end() && fitted->value > 0.0)
      ratios.push_back(std::log(fitted->value / vehicle.priors[i].mean));
  }
  if (ratios.empty()) return std::nullopt;
  const double ratio = std::exp(median(std::move(ratios)));
  if (ratio > 1.0 / kFar && ratio < kFar) return std::nullopt;
  std::array<char, 128> words{};
  std::snprintf(words.data(), words.size(), "the motion goes with inertias %.3g times those of the vehicle file",
                ratio);
  ConsistencyFinding finding{.run = "all",
                             .signal = "thrusters",
                             .reference = "vehicle file",
                             .finding = "scale",
                             .size = ratio,
                             .evidence = words.data(),
                             .action = "not corrected: look at the unit of the forces, and at the file's mass"};
  for (const Unit& unit : {Unit{1e-3, "the forces are in kN"}, Unit{1.0 / kNewtonsInKgf, "the forces are in kgf"},
                           Unit{1e3, "the forces are in mN"}}) {
    if (std::abs(std::log(ratio / unit.factor)) < std::log(kAlike))
      finding.action = std::string("not corrected: it is as if ") + unit.words;
  }
  return finding;
}

}  // namespace fathom::diagnosis
