// A made-up search for tests of what is concluded from one: no fits.
#pragma once

#include <doctest/doctest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/left_over.hpp"
#include "common/diagnosis/verdict.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::diagnosis {

struct MadeUp {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  SearchResult found;
  std::vector<Association> left;
  bool measured_attitude = true;

  MadeUp() {
    found.before.model = model::nominal_model(vehicle, false);
    found.after.model = found.before.model;
    found.after.window_cost.assign(50, 1.0);
  }
  Judged& accept(const std::string& name, std::vector<double> theta, int variant = 0,
                 const std::string& variant_name = "") {
    model::ActiveEffect effect = test::active(name, std::move(theta), variant);
    effect.variant_name = variant_name;
    found.after.model.add(effect);
    found.accepted.push_back({.effect = model::find_effect(name),
                              .variant = variant,
                              .variant_name = variant_name,
                              .log_odds = 20.0,
                              .error_reduction = 0.3});
    return found.accepted.back();
  }
  void refuse(const std::string& name, double log_odds, const std::string& reason, double saves = 0.004) {
    found.refused.push_back(
        {.effect = model::find_effect(name), .log_odds = log_odds, .error_reduction = saves, .reason = reason});
  }
  /// Standard deviations as shares of the numbers, in the order of the fit's parameters.
  void known_to(double base, const std::vector<double>& effects) {
    const std::vector<NamedValue> values = found.after.parameters();
    const auto n = static_cast<Eigen::Index>(values.size());
    const auto first = n - static_cast<Eigen::Index>(effects.size());
    found.after.covariance = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double share = i < first ? base : effects[static_cast<std::size_t>(i - first)];
      const double std = share * values[static_cast<std::size_t>(i)].value;
      found.after.covariance(i, i) = std * std;
    }
  }
  [[nodiscard]] model::Scene scene() const {
    model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = measured_attitude, .velocity = true};
    scene.rates = true;
    return scene;
  }
  [[nodiscard]] DiagnosisResult concluded() const {
    DiagnosisResult result;
    result.improvement = {0.4, 0.3, 0.5};
    conclude(found, left, scene(), result);
    return result;
  }
};

inline bool says(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

/// Every effect of the registry exactly once.
inline void check_all_listed(const DiagnosisResult& result) {
  std::multiset<std::string> listed, registered;
  for (const CandidateTried& candidate : result.candidates) {
    listed.insert(candidate.name);
    CHECK_FALSE(candidate.reason.empty());
  }
  for (const model::Effect* effect : model::all_effects()) registered.insert(std::string{effect->name()});
  CHECK(listed == registered);
}

}  // namespace fathom::diagnosis
