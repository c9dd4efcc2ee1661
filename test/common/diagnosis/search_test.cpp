// The search finds what a dive hides: each effect of the registry by name and number, nothing on a clean dive, and no
// confident name for physics that the registry does not hold. The test draws the sizes; the code cannot know them.
#include "common/diagnosis/search.hpp"

#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include "common/diagnosis/judgement.hpp"
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
constexpr double kLong = 330.0;   // s, for the survey

/// An effect whose numbers the test draws from an ordinary range.
struct Hidden {
  const char* name;
  const char* variant;  // empty: the first that can act
  std::vector<std::array<double, 2>> range;
};

const std::vector<Hidden>& hidden_effects() {
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
      {"fluid_memory", "u", {{10.0, 20.0}, {10.0, 20.0}, {10.0, 20.0}, {1.0, 2.0}, {1.0, 2.0}, {1.0, 2.0}, {1.0, 3.0}}},
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

test::DiveSettings dive_settings(double duration, unsigned seed) {
  return {.duration = duration, .dt = 0.1, .seed = seed, .velocity_noise = 0.005, .rate_noise = 0.0035};
}

/// Nothing when the effect cannot act on this vehicle.
std::optional<model::ActiveEffect> draw(const Hidden& one, const model::Vehicle& vehicle, double duration,
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

Outcome search_dive(const model::Vehicle& vehicle, const std::vector<model::ActiveEffect>& effects, double duration,
                    unsigned seed) {
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

void check_finds(const std::string& vehicle_name, const Hidden& one, double duration, unsigned seed) {
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

/// Lift: sway of a hull that flies at an angle, a product of two speeds.
class Lift final : public Outsider {
 public:
  std::string_view name() const override { return "lift"; }
  void load(const model::Motion& motion, model::EffectTheta theta, int, model::Load& load) const override {
    load.wrench[1] += theta[0] * motion.nu[0] * motion.nu[1];
    load.wrench[2] += theta[0] * motion.nu[0] * motion.nu[2];
  }
};

/// A spinning wheel on board: turning about one axis pushes about another.
class Gyroscope final : public Outsider {
 public:
  std::string_view name() const override { return "gyroscope"; }
  void load(const model::Motion& motion, model::EffectTheta theta, int, model::Load& load) const override {
    load.wrench.tail<3>() -= motion.nu.tail<3>().cross(Eigen::Vector3d(theta[0], 0.0, 0.0));
    load.wrench[5] += theta[0] * motion.nu[0] * motion.nu[2];
  }
};

/// A pump: a force that swells and fades with time, ever faster.
class Pump final : public Outsider {
 public:
  std::string_view name() const override { return "pump"; }
  void load(const model::Motion& motion, model::EffectTheta theta, int, model::Load& load) const override {
    load.wrench[1] += theta[0] * std::sin(0.3 * motion.t + 0.006 * motion.t * motion.t);
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
  check_finds("seabotix_lbv150", hidden("cross_coupling"), kShort, 5);
  if (!test::kTimed) return;  // every search walks the same code: one shows the sanitizers what there is to see
  check_finds("bluerov2", hidden("thruster_lag"), kShort, 1);
  check_finds("bluerov2", hidden("thruster_gain"), kShort, 2);
  check_finds("bluerov2", hidden("current"), kShort, 3);
  check_finds("bluerov2", hidden("thrust_asymmetry"), kShort, 4);
}

TEST_CASE("search: a lag of second order is one effect, not a delay and a lag that imitate it together") {
  if (!test::kTimed) return;
  const model::Vehicle& vehicle = vehicle_named("bluerov2");
  for (const double time_constant : {0.1, 0.2}) {
    CAPTURE(time_constant);
    test::DiveSettings settings = dive_settings(kShort, 6);
    settings.velocity_noise = settings.rate_noise = 0.002;  // quiet enough to tell laws of one effect apart
    settings.dt = 0.04;                                     // and quick enough for their memory
    constexpr int kSecondOrder = 3;
    settings.effects = {test::active("thruster_lag", {time_constant, 0.0}, kSecondOrder)};
    const test::VirtualDive dive = test::make_dive(vehicle, settings);
    const SearchResult found = search(vehicle, {&dive.trial, 1}, {}, [](const std::string&, double) {});
    std::string said;
    for (const Judged& judged : found.accepted)
      said += std::string(judged.effect->name()) + " " + judged.variant_name + ", saves " +
              std::to_string(judged.error_reduction) + "; ";
    CAPTURE(said);
    REQUIRE(found.accepted.size() == 1);
    CHECK(found.accepted[0].effect->name() == "thruster_lag");
    CHECK(found.accepted[0].variant == kSecondOrder);
  }
}

TEST_CASE("search: a large change of payload is named, whatever its moment") {
  if (!test::kTimed) return;
  constexpr double kMass = 3.0, kWeight = 15.0;  // kg, N: far more than what the vehicle floats by
  std::mt19937 random{20261121};
  const double moment = std::uniform_real_distribution<double>{170.0, 210.0}(random);
  CAPTURE(moment);
  const Outcome outcome = search_dive(vehicle_named("seabotix_lbv150"),
                                      {test::active("payload_change", {kMass, kWeight, moment})}, kLong, 1);
  CAPTURE(outcome.said);
  REQUIRE_FALSE(outcome.found.accepted.empty());
  CHECK(outcome.found.accepted.front().effect->name() == "payload_change");
}

TEST_CASE("search: a boundary that is felt exponentially is named with its reach") {
  if (!test::kTimed) return;
  check_finds("seabotix_lbv150",
              {"bottom_effect", "exponential force", {{4.0, 6.0}, {0.0, 0.0}, {0.5, 0.8}, {-0.1, 0.1}}}, kLong, 6);
  check_finds("seabotix_lbv150",
              {"wall_effect", "exponential force", {{4.0, 6.0}, {0.0, 0.0}, {0.0, 0.0}, {0.8, 1.2}, {-0.1, 0.1}}},
              kLong, 7);
}

TEST_CASE("search: drag that grows away from a far anchor looks like a wall's, and is named or among what it may be") {
  if (!test::kTimed) return;
  std::mt19937 random{20261122};
  const double away = std::uniform_real_distribution<double>{10.0, 14.0}(random);  // m
  const double bearing = std::uniform_real_distribution<double>{-3.0, 3.0}(random);
  CAPTURE(bearing);
  const Outcome outcome = search_dive(
      vehicle_named("bluerov2"),
      {test::active("tether_drag", {3.0, away * std::cos(bearing), away * std::sin(bearing), 1.0})}, kShort, 2);
  CAPTURE(outcome.said);
  REQUIRE_FALSE(outcome.found.accepted.empty());
  const Judged& first = outcome.found.accepted.front();
  const bool among =
      std::ranges::find(first.alternatives, "tether_drag", &Alternative::name) != first.alternatives.end();
  CHECK((first.effect->name() == "tether_drag" || among));
  MESSAGE(outcome.said);
}

TEST_CASE("search: a narrow dead band is named") {
  if (!test::kTimed) return;
  std::mt19937 random{20261121};
  const double half_width = std::uniform_real_distribution<double>{0.8, 1.2}(random);  // N
  CAPTURE(half_width);
  const Outcome outcome =
      search_dive(vehicle_named("seabotix_lbv150"), {test::active("thruster_deadband", {half_width}, 1)}, kShort, 1);
  CAPTURE(outcome.said);
  REQUIRE_FALSE(outcome.found.accepted.empty());
  CHECK(outcome.found.accepted.front().effect->name() == "thruster_deadband");
}

TEST_CASE("search: a craft that hangs askew is named, though its base model knows no righting moment") {
  if (!test::kTimed) return;
  model::Vehicle vehicle = vehicle_named("beluga");
  for (std::size_t i = vehicle.parameters.size(); i-- > 0;) {
    if (!vehicle.parameters[i].starts_with("G_")) continue;
    const auto at = static_cast<std::ptrdiff_t>(i);
    vehicle.parameters.erase(vehicle.parameters.begin() + at);
    vehicle.priors.erase(vehicle.priors.begin() + at);
  }
  for (unsigned seed = 1; seed <= 2; ++seed) {  // the second hangs so stiff that no small pendulum helps
    std::mt19937 random{seed};
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>{low, high}(random);
    };
    const std::vector<double> moment{between(-1.5, 1.5), between(-1.5, 1.5), between(2.0, 6.0)};  // N m
    const Outcome outcome = search_dive(vehicle, {test::active("restoring_moment", moment, 7)}, kShort, seed);
    CAPTURE(outcome.said);
    REQUIRE_FALSE(outcome.found.accepted.empty());
    CHECK(outcome.found.accepted.front().effect->name() == "restoring_moment");
  }
}

TEST_CASE("search: a clean dive gets no name") {
  check_clean("seabotix_lbv150", kShort, 1);
  if (test::kTimed) check_clean("bluerov2", kShort, 2);
}

TEST_CASE("search: what imitates a delay that is too quick to be told is not accepted in its place") {
  if (!test::kTimed) return;
  const model::Vehicle& vehicle = vehicle_named("seabotix_lbv150");
  const model::ActiveEffect delay = test::active("thruster_delay", {0.012});  // commands are 0.04 s apart
  const test::VirtualDive dive = test::make_dive(
      vehicle, {.duration = 200.0, .dt = 0.04, .seed = 5, .turn = 4.0, .input_hold = 0.5, .effects = {delay}});
  const SearchResult found = search(vehicle, {&dive.trial, 1}, {}, [](const std::string&, double) {});
  for (const Judged& judged : found.accepted) {
    MESSAGE(std::string{judged.effect->name()} << " " << judged.variant_name << " log odds " << judged.log_odds);
  }
  CHECK(found.accepted.empty());
  const auto told = std::ranges::find(found.refused, delay.effect, &Judged::effect);
  REQUIRE(told != found.refused.end());
  CHECK(told->log_odds > Settings{}.accept_log_odds);  // or it would have been refused anyway
  CHECK(told->reason == std::string{kTooQuick});
}

TEST_CASE("search: what the registry does not hold gets no confident name") { check_outsider(Lift{}, 15.0, 11); }

// One case per effect, so that --test-case can choose.
#define EFFECT(name)                                                                                                  \
  TEST_CASE("search survey: " #name " on two vehicles" * doctest::skip() * doctest::description("slow: --no-skip")) { \
    for (const char* vehicle : {"seabotix_lbv150", "bluerov2"}) {                                                     \
      check_finds(vehicle, hidden(#name), kLong, 1);                                                                  \
    }                                                                                                                 \
  }
#include "common/model/effects/effects.def"
#undef EFFECT

TEST_CASE("search survey: clean dives" * doctest::skip() * doctest::description("slow: --no-skip")) {
  for (const char* vehicle : {"seabotix_lbv150", "bluerov2"}) {
    for (unsigned seed = 1; seed <= 6; ++seed) check_clean(vehicle, kLong, seed);
  }
}

TEST_CASE("search survey: outsiders" * doctest::skip() * doctest::description("slow: --no-skip")) {
  check_outsider(Lift{}, 15.0, 12);
  check_outsider(Gyroscope{}, 3.0, 13);
  check_outsider(Pump{}, 3.0, 14);
}
