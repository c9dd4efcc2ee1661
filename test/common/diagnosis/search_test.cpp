// The search finds what a dive hides: each effect of the registry by name and number, nothing on a clean dive, and no
// confident name for physics that the registry does not hold. The test draws the sizes; the code cannot know them.
#include "common/diagnosis/search.hpp"

#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <random>

#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr double kDeviations = 4.0;       // of the stated std: one miss in 16000 were it exact, with few windows more
constexpr double kRelative = 0.05;        // a number this close is as good as the dive's own step of 100 ms allows
constexpr double kNothing = 1e-9;         // true numbers below this are "absent": judged by deviations only
constexpr double kConfidentShare = 0.02;  // of the error (RMS): what a wrong name may explain before it misleads

constexpr double kShort = 120.0;  // s: enough for the plain ones
constexpr double kLong = 200.0;   // s, for the survey

/// An effect whose numbers the test draws from an ordinary range.
struct Hidden {
  const char* name;
  const char* variant;  // empty: the first
  std::vector<std::array<double, 2>> range;
};

const std::vector<Hidden>& hidden_effects() {
  static const std::vector<Hidden> kAll{
      {"thruster_lag", "", {{0.15, 0.35}}},
      {"thruster_delay", "", {{0.12, 0.3}}},
      {"cross_coupling", "Y_r", {{4.0, 8.0}}},
      {"thrust_asymmetry", "", {{-0.3, -0.15}}},
      {"thruster_gain", "", {{-0.3, -0.2}}},
      {"thruster_deadband", "", {{0.5, 0.8}}},
      {"battery_sag", "", {{1.0, 2.0}}},
      {"tether_tension", "", {{1.2, 2.0}, {0.8, 1.2}, {1.2, 1.8}, {0.4, 0.6}, {0.0, 0.0}}},
      {"current", "", {{0.06, 0.1}, {-0.07, -0.04}}},
      {"asymmetric_drag", "", {{-10.0, -7.0}}},
      {"thrust_overshoot", "", {{0.35, 0.5}, {0.7, 1.0}}}};
  return kAll;
}

const Hidden& hidden(const std::string& name) {
  for (const Hidden& one : hidden_effects()) {
    if (name == one.name) return one;
  }
  FAIL("no range for " << name);
  return hidden_effects().front();
}

const model::Vehicle& vehicle_named(const std::string& name) {
  static std::map<std::string, model::Vehicle> loaded;
  const auto known = loaded.find(name);
  return known != loaded.end() ? known->second
                               : loaded.emplace(name, test::vehicle_from_repository(name)).first->second;
}

model::ActiveEffect draw(const Hidden& one, const model::Vehicle& vehicle, unsigned seed) {
  std::mt19937 random{seed};
  std::vector<double> theta;
  for (const auto& [low, high] : one.range) theta.push_back(std::uniform_real_distribution<double>{low, high}(random));
  int variant = 0;
  model::Scene scene{.vehicle = &vehicle};
  scene.nu_rms.setOnes();
  const auto names = model::find_effect(one.name)->variants(scene);
  for (std::size_t v = 0; v < names.size(); ++v) {
    if (names[v] == one.variant) variant = static_cast<int>(v);
  }
  return test::active(one.name, theta, variant);
}

struct Outcome {
  SearchResult found;
  std::string said;  // for messages
  double seconds{};
};

Outcome search_dive(const model::Vehicle& vehicle, const std::vector<model::ActiveEffect>& effects, double duration,
                    unsigned seed) {
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = duration,
                                                           .dt = 0.1,
                                                           .seed = seed,
                                                           .velocity_noise = 0.005,
                                                           .rate_noise = 0.0035,
                                                           .effects = effects});
  const auto begin = std::chrono::steady_clock::now();
  Outcome outcome{.found = search(vehicle, {&dive.trial, 1}, {}, [](const std::string&, double) {})};
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const Judged& judged : outcome.found.accepted) {
    outcome.said += std::string(judged.effect->name()) + "(" + judged.variant_name + ") log odds " +
                    std::to_string(judged.log_odds) + " saves " + std::to_string(judged.error_reduction) + "; ";
  }
  return outcome;
}

void check_finds(const std::string& vehicle_name, const std::string& name, double duration, unsigned seed) {
  const model::Vehicle& vehicle = vehicle_named(vehicle_name);
  const model::ActiveEffect truth = draw(hidden(name), vehicle, seed);
  const Outcome outcome = search_dive(vehicle, {truth}, duration, seed + 100);
  MESSAGE(vehicle_name << " seed " << seed << " hides " << name << ": " << outcome.said << outcome.seconds << " s");
  CHECK_FALSE(outcome.found.accepted.empty());
  if (outcome.found.accepted.empty()) return;
  const Judged& first = outcome.found.accepted.front();
  CHECK(first.effect->name() == name);
  CHECK(first.variant == truth.variant);
  CHECK(first.log_odds > Settings{}.accept_log_odds);
  std::size_t compared = 0;
  for (const NamedValue& value : outcome.found.after.parameters()) {
    if (!value.name.starts_with(name + ".")) continue;
    if (compared == truth.theta.size()) break;  // a second form of the same effect
    const double expected = truth.theta[compared++];
    CAPTURE(value.name);
    CAPTURE(value.value);
    CAPTURE(value.std);
    CAPTURE(expected);
    CHECK(value.std > 0.0);
    const double error = std::abs(value.value - expected);
    const bool close = std::abs(expected) > kNothing && error < kRelative * std::abs(expected);
    CHECK((close || error < kDeviations * value.std));
  }
  CHECK(compared == truth.theta.size());
}

void check_clean(const std::string& vehicle_name, double duration, unsigned seed) {
  const Outcome outcome = search_dive(vehicle_named(vehicle_name), {}, duration, seed + 100);
  MESSAGE(vehicle_name << " seed " << seed << " hides nothing: " << outcome.said << outcome.seconds << " s");
  CHECK(outcome.found.accepted.empty());
  CHECK_FALSE(outcome.found.refused.empty());
  CHECK(outcome.found.after.cost == outcome.found.before.cost);
}

/// Physics that the registry does not hold.
class Outsider : public model::Effect {
 public:
  std::string_view sentence() const override { return "Not in the registry."; }
  std::string_view revealed_by() const override { return "nothing"; }
  std::span<const model::EffectParameter> parameters() const override {
    static constexpr std::array kOne{model::EffectParameter{"size", "", 1.0}};
    return kOne;
  }
};

/// Waves: a force along the world's north that swings with time alone.
class Waves final : public Outsider {
 public:
  std::string_view name() const override { return "waves"; }
  void load(const model::Motion& motion, model::EffectTheta theta, int, model::Load& load) const override {
    load.wrench.head<3>() += motion.R_WB.transpose() * Eigen::Vector3d(theta[0] * std::sin(0.9 * motion.t), 0.0, 0.0);
  }
};

/// Lift: sway of a hull that flies at an angle, a product of two speeds.
class Lift final : public Outsider {
 public:
  std::string_view name() const override { return "lift"; }
  void load(const model::Motion& motion, model::EffectTheta theta, int, model::Load& load) const override {
    load.wrench[1] += theta[0] * motion.nu[0] * motion.nu[1];
    load.wrench[2] += theta[0] * motion.nu[0] * motion.nu[2];
  }
};

/// A hull that is squeezed with depth: weight that grows with the square of the way down.
class Squeeze final : public Outsider {
 public:
  std::string_view name() const override { return "squeeze"; }
  bool feels_place() const override { return true; }
  void load(const model::Motion& motion, model::EffectTheta theta, int, model::Load& load) const override {
    const double z = motion.p_WB.z();
    load.wrench.head<3>() += motion.R_WB.transpose() * Eigen::Vector3d(0.0, 0.0, -theta[0] * z * std::abs(z));
  }
};

void check_outsider(const Outsider& outsider, double size, unsigned seed) {
  const model::Vehicle& vehicle = vehicle_named("seabotix_lbv150");
  const Outcome outcome = search_dive(vehicle, {{&outsider, 0, "", {size}}}, kShort, seed);
  MESSAGE(outsider.name() << " outside the registry: " << (outcome.said.empty() ? "no name; " : outcome.said)
                          << outcome.seconds << " s, residual scale " << outcome.found.before.sigma.transpose());
  // It was strong enough to be seen at all: the noise put in is 5 mm/s.
  CHECK(outcome.found.before.sigma.head<3>().maxCoeff() > 0.01);
  for (const Judged& judged : outcome.found.accepted) {
    CAPTURE(judged.effect->name());
    CHECK(judged.error_reduction < kConfidentShare);
  }
}

}  // namespace

TEST_CASE("search: every effect of the registry has a range to be drawn from") {
  for (const model::Effect* effect : model::all_effects()) hidden(std::string{effect->name()});
  CHECK(hidden_effects().size() == model::all_effects().size());
}

TEST_CASE("search: hidden effects are named first, with their numbers") {
  check_finds("seabotix_lbv150", "cross_coupling", kShort, 5);
  if (!test::kTimed) return;  // every search walks the same code: one shows the sanitizers what there is to see
  check_finds("bluerov2", "thruster_lag", kShort, 1);
  check_finds("bluerov2", "thruster_gain", kShort, 2);
  check_finds("bluerov2", "current", kShort, 3);
  check_finds("bluerov2", "thrust_asymmetry", kShort, 4);
}

TEST_CASE("search: a clean dive gets no name") {
  check_clean("seabotix_lbv150", kShort, 1);
  if (test::kTimed) check_clean("bluerov2", kShort, 2);
}

TEST_CASE("search: what the registry does not hold gets no confident name") { check_outsider(Waves{}, 3.0, 11); }

TEST_CASE("search survey: every effect on two vehicles" * doctest::skip() * doctest::description("slow: --no-skip")) {
  for (const char* vehicle : {"seabotix_lbv150", "bluerov2"}) {
    for (const model::Effect* effect : model::all_effects()) {
      for (const unsigned seed : {1U, 2U}) {
        check_finds(vehicle, std::string{effect->name()}, kLong, seed);
      }
    }
  }
}

TEST_CASE("search survey: clean dives" * doctest::skip() * doctest::description("slow: --no-skip")) {
  for (const char* vehicle : {"seabotix_lbv150", "bluerov2"}) {
    for (unsigned seed = 1; seed <= 6; ++seed) check_clean(vehicle, kLong, seed);
  }
}

TEST_CASE("search survey: outsiders" * doctest::skip() * doctest::description("slow: --no-skip")) {
  check_outsider(Lift{}, 15.0, 12);
  check_outsider(Squeeze{}, 3.0, 13);
  check_outsider(Waves{}, 3.0, 14);
}
