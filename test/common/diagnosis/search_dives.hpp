// Dives that hide a drawn effect, or nothing, and what a search finds in them. The test draws the sizes; the code
// cannot know them.
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/search.hpp"
#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::diagnosis {

inline constexpr double kDeviations = 4.0;  // of the stated std: one miss in 16000 were it exact, with few windows more
inline constexpr double kRelative = 0.05;   // a number this close is as good as the dive's own step of 100 ms allows
inline constexpr double kNothing = 1e-9;    // true numbers below this are "absent": judged by deviations only

inline constexpr double kShort = 120.0;  // s: enough for the plain ones
inline constexpr double kLong = 330.0;   // s, for the survey

/// An effect whose numbers the test draws from an ordinary range.
struct Hidden {
  const char* name;
  const char* variant;  // empty: the first that can act
  std::vector<std::array<double, 2>> range;
};

inline const std::vector<Hidden>& hidden_effects() {
  static const std::vector<Hidden> kAll{
      {"thruster_lag", "", {{0.15, 0.35}}},
      {"thruster_delay", "", {{0.12, 0.3}}},
      {"centre_of_mass", "", {{0.04, 0.06}, {-0.06, -0.04}, {0.03, 0.05}}},
      {"cross_coupling", "Y_r", {{4.0, 8.0}}},
      {"thrust_asymmetry", "", {{-0.3, -0.15}}},
      {"thruster_gain", "", {{-0.3, -0.2}}},
      {"thruster_failure", "", {{0.4, 0.7}, {60.0, 140.0}}},
      {"thruster_misalignment", "", {{0.15, 0.3}}},
      {"thruster_deadband", "", {{0.5, 0.8}}},
      {"battery_sag", "", {{1.0, 2.0}}},
      {"tether_tension", "", {{1.2, 2.0}, {0.8, 1.2}, {1.2, 1.8}, {0.4, 0.6}, {0.0, 0.0}}},
      {"tether_drag", "", {{8.0, 12.0}, {1.5, 2.5}, {0.5, 1.0}, {0.0, 0.0}}},
      {"current", "", {{0.06, 0.1}, {-0.07, -0.04}}},
      {"wave", "force", {{1.0, 2.0}, {1.0, 2.0}, {0.3, 1.2}, {0.7, 1.5}}},
      {"thrust_loss", "shaft speed", {{0.8, 1.3}}},
      {"asymmetric_drag", "X_|u| X_uu", {{-10.0, -7.0}, {-5.0, -3.0}}},
      {"cubic_drag", "X_uuu", {{80.0, 140.0}}},
      {"speed_drag", "", {{30.0, 60.0}}},
      {"body_lift", "N_uv", {{10.0, 20.0}}},
      {"turning_resistance", "X_vr", {{10.0, 20.0}}},
      {"steady_force", "", {{2.0, 3.0}, {-3.0, -2.0}}},
      {"wind", "", {{4.0, 6.0}, {-3.0, -2.0}, {0.1, 0.2}}},
      {"fluid_memory",
       "u",
       {{10.0, 20.0}, {10.0, 20.0}, {10.0, 20.0}, {1.0, 2.0}, {1.0, 2.0}, {1.0, 2.0}, {1.0, 3.0}, {0.0, 0.0}}},
      {"restoring_moment", "", {{3.0, 5.0}, {3.0, 5.0}, {3.0, 5.0}}},
      {"compressibility", "", {{0.6, 1.0}}},
      {"payload_change", "", {{1.5, 3.0}, {-3.0, -2.0}, {60.0, 140.0}}},
      // Places of boundaries are counted from the deepest, or the most northern, place of the dive.
      {"bottom_effect", "force", {{6.0, 10.0}, {0.8, 1.2}}},
      {"wall_effect", "force", {{6.0, 10.0}, {0.0, 0.0}, {0.8, 1.2}}},
      {"lever_arm", "", {{0.2, 0.3}, {-0.15, -0.1}, {0.0, 0.0}}},
      {"sensor_scale", "u", {{0.15, 0.25}}},
      {"sensor_latency", "velocity", {{0.15, 0.3}}},
      {"thrust_overshoot", "", {{0.35, 0.5}, {0.7, 1.0}}}};
  return kAll;
}

inline const Hidden& hidden(const std::string& name) {
  for (const Hidden& one : hidden_effects()) {
    if (name == one.name) return one;
  }
  FAIL("no range for " << name);
  return hidden_effects().front();
}

inline const model::Vehicle& vehicle_named(const std::string& name) {
  static std::map<std::string, model::Vehicle> loaded;
  const auto known = loaded.find(name);
  return known != loaded.end() ? known->second
                               : loaded.emplace(name, test::vehicle_from_repository(name)).first->second;
}

inline test::DiveSettings dive_settings(double duration, unsigned seed) {
  return {.duration = duration, .dt = 0.1, .seed = seed, .velocity_noise = 0.005, .rate_noise = 0.0035};
}

/// Nothing when the effect cannot act on this vehicle.
inline std::optional<model::ActiveEffect> draw(const Hidden& one, const model::Vehicle& vehicle, double duration,
                                               unsigned seed) {
  std::mt19937 random{seed};
  std::vector<double> theta;
  for (const auto& [low, high] : one.range) theta.push_back(std::uniform_real_distribution<double>{low, high}(random));
  const test::VirtualDive clean = test::make_dive(vehicle, dive_settings(duration, seed + 100));
  const model::Scene scene = model::scene_of(vehicle, {&clean.trial, 1});
  const auto names = model::find_effect(one.name)->variants(scene);
  const std::string wanted = one.variant;
  for (std::size_t v = 0; v < names.size(); ++v) {
    if (wanted.empty() ? names[v] == "-" : names[v] != wanted) continue;
    const model::Effect& effect = *model::find_effect(one.name);
    for (std::size_t i = 0; i < theta.size(); ++i) {
      const std::string_view number = effect.parameters()[i].name;
      if (number == "bottom_depth" || number == "at_depth") theta[i] += scene.p_high.z();
      if (number == "distance" || number == "at_distance") theta[i] += scene.p_high.x();
    }
    return test::active(one.name, theta, static_cast<int>(v));
  }
  return std::nullopt;
}

struct Outcome {
  SearchResult found;
  std::string said;  // for messages
  double seconds{};
};

inline Outcome search_dive(const model::Vehicle& vehicle, const std::vector<model::ActiveEffect>& effects,
                           double duration, unsigned seed) {
  test::DiveSettings settings = dive_settings(duration, seed);
  settings.effects = effects;
  const test::VirtualDive dive = test::make_dive(vehicle, settings);
  const auto begin = std::chrono::steady_clock::now();
  Outcome outcome{.found = search(vehicle, {&dive.trial, 1}, {}, [](const std::string&, double) {})};
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const Judged& judged : outcome.found.accepted) {
    outcome.said += std::string(judged.effect->name()) + "(" + judged.variant_name + ") log odds " +
                    std::to_string(judged.log_odds) + " saves " + std::to_string(judged.error_reduction);
    for (const Alternative& other : judged.alternatives) outcome.said += " or " + other.name;
    outcome.said += "; ";
  }
  if (outcome.found.accepted.empty()) {
    outcome.said = "nothing; refused: ";
    for (std::size_t i = 0; i < std::min<std::size_t>(3, outcome.found.refused.size()); ++i) {
      const Judged& judged = outcome.found.refused[i];
      outcome.said += std::string(judged.effect->name()) + "(" + judged.variant_name + ") saves " +
                      std::to_string(judged.error_reduction) + " " + judged.reason + "; ";
    }
  }
  return outcome;
}

inline void check_finds(const std::string& vehicle_name, const Hidden& one, double duration, unsigned seed) {
  const model::Vehicle& vehicle = vehicle_named(vehicle_name);
  const std::string name = one.name;
  const std::optional<model::ActiveEffect> drawn = draw(one, vehicle, duration, seed);
  if (!drawn) {
    MESSAGE(vehicle_name << " cannot show " << name);
    return;
  }
  const model::ActiveEffect& truth = *drawn;
  const Outcome outcome = search_dive(vehicle, {truth}, duration, seed + 100);
  MESSAGE(vehicle_name << " seed " << seed << " hides " << name << ": " << outcome.said << outcome.seconds << " s");
  CHECK_FALSE(outcome.found.accepted.empty());
  if (outcome.found.accepted.empty()) return;
  const Judged& first = outcome.found.accepted.front();
  CHECK(first.effect->name() == name);
  CHECK(first.variant == truth.variant);
  CHECK(first.log_odds > Settings{}.accept_log_odds);
  for (const Judged& judged : outcome.found.accepted) CHECK(judged.effect->name() == name);
  std::vector<double> hidden_numbers;
  for (std::size_t i = 0; i < truth.theta.size(); ++i) {
    if (truth.effect->takes_part(truth.variant, i)) hidden_numbers.push_back(truth.theta[i]);
  }
  std::size_t compared = 0;
  const std::vector<NamedValue> numbers = outcome.found.after.parameters();
  for (const NamedValue& value : numbers) {
    // An exponential strength is told for another place than the hidden one.
    const std::size_t last = truth.theta.size() - 1;
    if (truth.effect->is_given(truth.variant, last) &&
        (value.name == name + ".at_depth" || value.name == name + ".at_distance"))
      hidden_numbers[0] *= std::exp((value.value - truth.theta[last]) / truth.theta[last - 1]);
  }
  for (const NamedValue& value : numbers) {
    if (!value.name.starts_with(name + ".")) continue;
    const auto all = truth.effect->parameters();
    const auto number = std::ranges::find(all, value.name.substr(name.size() + 1), &model::EffectParameter::name);
    if (!truth.effect->takes_part(truth.variant, static_cast<std::size_t>(number - all.begin()))) continue;
    if (compared == hidden_numbers.size()) break;  // a second form of the same effect
    const double expected = hidden_numbers[compared++];
    // A wave from the other side with the other sign is the same wave.
    if (name == "wave" && !value.name.ends_with("frequency")) continue;
    CAPTURE(value.name);
    CAPTURE(value.value);
    CAPTURE(value.std);
    CAPTURE(expected);
    CHECK(value.std > 0.0);
    const double error = std::abs(value.value - expected);
    const bool close = std::abs(expected) > kNothing && error < kRelative * std::abs(expected);
    CHECK((close || error < kDeviations * value.std));
  }
  CHECK(compared == hidden_numbers.size());
}

inline void check_clean(const std::string& vehicle_name, double duration, unsigned seed) {
  const Outcome outcome = search_dive(vehicle_named(vehicle_name), {}, duration, seed + 100);
  MESSAGE(vehicle_name << " seed " << seed << " hides nothing: " << outcome.said << outcome.seconds << " s");
  CHECK(outcome.found.accepted.empty());
  CHECK_FALSE(outcome.found.refused.empty());
  CHECK(outcome.found.after.cost == outcome.found.before.cost);
}

}  // namespace fathom::diagnosis
