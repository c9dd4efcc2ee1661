// The search finds what a dive hides: each effect of the registry by name and number, and nothing on a clean dive.
#include "test/common/diagnosis/search_dives.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

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
