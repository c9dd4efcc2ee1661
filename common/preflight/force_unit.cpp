#include "common/preflight/force_unit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/base/statistics.hpp"
#include "common/model/parameters.hpp"

namespace fathom::preflight {
namespace {

constexpr double kNewtonsInKgf = 9.80665;
constexpr double kAlike = 1.7;  // of a unit's factor: as well as a vehicle file knows its masses
// How well a file knows the logarithm of an inertia. Of a mass the added water is in doubt, as far as its prior says:
// where the file says nothing of it, half the body's is a guess. Of a moment of inertia, the distribution of mass too.
constexpr double kMassDoubt = 0.3, kGuessedMassDoubt = 0.5, kMomentDoubt = 0.7;
constexpr double kMost = 6.0;      // doubts: further off is no better known
constexpr double kPrice = 6.0;     // log likelihood, of one factor on all thrust, as of one wrong thruster
constexpr double kCertain = 20.0;  // log likelihood over the file as it is, as of wrong thrusters

struct Unit {
  double factor;
  const char* words;
};

/// A fitted inertia over the expected one.
struct Ratio {
  double log;
  double doubt;
  [[nodiscard]] double cost(double log_factor) const {
    const double off = std::min(std::abs(log - log_factor) / doubt, kMost);
    return 0.5 * off * off;
  }
};

std::string explained_by(double ratio) {
  std::array<char, 192> words{};
  std::snprintf(words.data(), words.size(),
                "not corrected: all thrust about %.2g times what is filed would explain it (curve, unit, scale of the "
                "wrench); else the file's mass is wrong",
                1.0 / ratio);
  return words.data();
}

double cost_of(const std::vector<Ratio>& ratios, double log_factor) {
  double cost = 0.0;
  for (const Ratio& one : ratios) cost += one.cost(log_factor);
  return cost;
}

}  // namespace

std::optional<ConsistencyFinding> compare_inertia(const model::Vehicle& vehicle,
                                                  std::span<const NamedValue> parameters) {
  std::vector<Ratio> ratios;
  std::vector<double> logs;
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    const auto parameter = model::parameter_from_name(vehicle.parameters[i]);
    if (!parameter || model::sign_constraint(*parameter) <= 0 || !(vehicle.priors[i].mean > 0.0)) continue;
    const auto fitted = std::ranges::find(parameters, vehicle.parameters[i], &NamedValue::name);
    if (fitted == parameters.end() || !(fitted->value > 0.0)) continue;
    const model::Prior& prior = vehicle.priors[i];
    logs.push_back(std::log(fitted->value / prior.mean));
    const double of_mass = std::clamp(prior.sigma / prior.mean, kMassDoubt, kGuessedMassDoubt);
    ratios.push_back({logs.back(), model::axis(*parameter) < 3 ? of_mass : kMomentDoubt});
  }
  if (ratios.empty()) return std::nullopt;
  const double factor = median(std::move(logs));
  if (cost_of(ratios, 0.0) - cost_of(ratios, factor) - kPrice < kCertain) return std::nullopt;
  const double ratio = std::exp(factor);
  std::array<char, 128> words{};
  std::snprintf(words.data(), words.size(), "the motion goes with inertias %.3g times those of the vehicle file",
                ratio);
  ConsistencyFinding finding{.run = "all",
                             .signal = "thrusters",
                             .reference = "vehicle file",
                             .finding = "scale",
                             .size = ratio,
                             .evidence = words.data(),
                             .action = explained_by(ratio)};
  for (const Unit& unit : {Unit{1e-3, "the forces are in kN"}, Unit{1.0 / kNewtonsInKgf, "the forces are in kgf"},
                           Unit{1e3, "the forces are in mN"}}) {
    if (std::abs(std::log(ratio / unit.factor)) < std::log(kAlike))
      finding.action = std::string("not corrected: it is as if ") + unit.words;
  }
  return finding;
}

}  // namespace fathom::preflight
