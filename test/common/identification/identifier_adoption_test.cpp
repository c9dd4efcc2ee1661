// An effect that the diagnoser accepts enters the model: its numbers and the vehicle's come right, the rest of the
// contract (bits, restart, leaving again) holds with it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/identification/identifier.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr Utime kStart = 1'600'000'000'000'000;
constexpr double kSigmas = 4.0;  // of one estimate

IdentifierSettings settings() {
  IdentifierSettings s;
  s.adopt_after = 2;
  s.adopt_delay = 1.0;
  return s;
}

EffectRanking accepted(double t, const model::ActiveEffect& effect, const std::string& verdict = "effect") {
  EffectRanking ranking{.utime = utime_after(kStart, t), .verdict = verdict};
  ranking.candidates.push_back({.name = std::string{effect.effect->name()},
                                .log_odds = 20.0,
                                .error_reduction = 0.3,
                                .variant = effect.variant_name,
                                .numbers = effect.theta});
  return ranking;
}

void feed(Identifier& identifier, const Trial& trial, double from, double to,
          const std::function<void(double)>& before = {}) {
  for (std::size_t k = 0; k < trial.size(); ++k) {
    if (trial.t[k] < from || trial.t[k] >= to) continue;
    if (before) before(trial.t[k]);
    const Utime utime = utime_after(kStart, trial.t[k]);
    Thrusters thrusters{.utime = utime};
    thrusters.force.assign(trial.input[k].data(), trial.input[k].data() + trial.input[k].size());
    (void)identifier.step(thrusters);
    (void)identifier.step(
        StateEstimate{.utime = utime, .p_WB = trial.p_WB[k], .q_WB = trial.q_WB[k], .nu = trial.nu[k], .valid = true});
  }
}

/// Says at 60, 70 and 80 s what the diagnoser would.
std::function<void(double)> diagnoser(Identifier& identifier, const model::ActiveEffect& found, double lateness = 0.0) {
  return [&identifier, found, lateness, next = 60.0](double t) mutable {
    if (next > 80.0 || t < next + lateness) return;
    identifier.hear(accepted(next, found));
    next += 10.0;
  };
}

model::ActiveEffect named(const model::Vehicle& vehicle, const std::string& name, std::vector<double> theta,
                          int variant) {
  model::ActiveEffect effect = test::active(name, std::move(theta), variant);
  if (name == "thruster_gain") effect.variant_name = vehicle.thrusters[static_cast<std::size_t>(variant)].name;
  return effect;
}

/// Largest error in the deviations that `stated` has.
double worst(const ModelEstimate& model, const model::Model& truth, const ModelEstimate& stated) {
  double largest = 0.0;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const NamedValue& p = model.parameters[i];
    const double value = truth.theta[model::index(*model::parameter_from_name(p.name))];
    largest = std::max(largest, std::abs(p.value - value) / stated.parameters[i].std);
  }
  return largest;
}

double worst(const ModelEstimate& model, const model::Model& truth) { return worst(model, truth, model); }

}  // namespace

TEST_CASE("adoption: an accepted effect is listed, its numbers are learnt, and the vehicle's come right") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  struct Case {
    model::ActiveEffect truth, found;  // as hidden, and as a diagnoser would roughly say
  };
  for (const Case& c : {Case{named(vehicle, "thruster_gain", {-0.4}, 1), named(vehicle, "thruster_gain", {-0.3}, 1)},
                        Case{named(vehicle, "current", {0.2, -0.25}, 0), named(vehicle, "current", {0.15, -0.2}, 0)},
                        Case{named(vehicle, "payload_change", {1.0, -4.0, 30.0}, 0),
                             named(vehicle, "payload_change", {0.4, -3.0, 32.5}, 0)},
                        Case{named(vehicle, "tether_tension", {3.0, 0.5, 2.0, -1.0, 0.0}, 0),
                             named(vehicle, "tether_tension", {2.2, 0.3, 1.8, -0.7, 0.2}, 0)}}) {
    CAPTURE(c.truth.effect->name());
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 200.0, .seed = 31, .effects = {c.truth}});
    Identifier without{settings(), vehicle}, with{settings(), vehicle};
    feed(without, dive.trial, 0.0, 1e9);
    feed(with, dive.trial, 0.0, 1e9, diagnoser(with, c.found));
    const ModelEstimate model = with.model();
    REQUIRE(model.effects == std::vector<std::string>{std::string{c.truth.effect->name()}});
    REQUIRE(std::ssize(model.effect_numbers) == c.truth.effect->numbers(c.truth.variant));  // the leading ones
    CHECK(model.parameters.size() == vehicle.parameters.size());
    CHECK(model.covariance.size() == model.parameters.size() * model.parameters.size());
    for (std::size_t i = 0; i < model.effect_numbers.size(); ++i) {
      const NamedValue& p = model.effect_numbers[i];
      CAPTURE(p.name);
      CAPTURE(p.value);
      CAPTURE(p.std);
      CAPTURE(c.truth.theta[i]);
      CHECK(std::abs(p.value - c.truth.theta[i]) < kSigmas * p.std);
    }
    CHECK(worst(model, dive.truth) < kSigmas);
    CHECK(worst(without.model(), dive.truth, model) > kSigmas);  // bent...
    CHECK(worst(without.model(), dive.truth) < kSigmas);         // ...and known to be
    CHECK(model.updates == without.model().updates);
    CHECK(without.model().effects.empty());
  }
}

TEST_CASE("adoption: numbers that hardly show yet do not run away, however rough the diagnoser's are") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::ActiveEffect truth = test::active("tether_drag", {5.5, -2.5, 0.0, -0.5});
  const model::ActiveEffect found = test::active("tether_drag", {6.5, -0.8, -0.6, 0.3});
  for (const unsigned seed : {32U, 33U, 34U}) {
    CAPTURE(seed);
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 120.0, .seed = seed, .effects = {truth}});
    Identifier identifier{settings(), vehicle};
    double next = 20.0, farthest = 0.0;
    feed(identifier, dive.trial, 0.0, 1e9, [&](double t) {
      if (t < next) return;
      const ModelEstimate model = identifier.model();
      for (std::size_t i = 0; i < model.effect_numbers.size(); ++i) {
        const NamedValue& p = model.effect_numbers[i];
        farthest = std::max(farthest, std::abs(p.value - truth.theta[i]) / p.std);
      }
      identifier.hear(accepted(next, found));
      next += 10.0;
    });
    REQUIRE(identifier.model().effect_numbers.size() == 4);
    CHECK(farthest < kSigmas + 1.0);  // the largest of forty
  }
}

TEST_CASE("adoption: a form with more numbers gives way to the ordinary one that leaves as little") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto apart = [](double all, double longer) {
    model::ActiveEffect effect = test::active("thruster_lag", {all, longer}, 1);
    effect.variant_name = "vertical thrusters apart";
    return effect;
  };
  const auto adopted = [&](const model::ActiveEffect& truth, const model::ActiveEffect& found) {
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 200.0, .seed = 31, .effects = {truth}});
    Identifier identifier{settings(), vehicle};
    feed(identifier, dive.trial, 0.0, 1e9, diagnoser(identifier, found));
    return identifier.model();
  };
  const ModelEstimate same = adopted(test::active("thruster_lag", {0.2, 0.0}), apart(0.18, 0.15));
  REQUIRE(same.effect_numbers.size() == 1);  // whatever is named from then on
  CHECK(std::abs(same.effect_numbers[0].value - 0.2) < kSigmas * same.effect_numbers[0].std);
  const ModelEstimate two = adopted(apart(0.15, 0.4), apart(0.13, 0.3));
  REQUIRE(two.effect_numbers.size() == 2);
  CHECK(std::abs(two.effect_numbers[1].value - 0.4) < kSigmas * two.effect_numbers[1].std);
}

TEST_CASE("adoption: what takes an axis away with its thrust, or has numbers that it cannot have, is not learnt") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::ActiveEffect truth = test::active("payload_change", {0.0, -3.5, 90.0});
  model::ActiveEffect found = test::active("thrust_overshoot", {0.975, 1.7}, 2);
  found.variant_name = "vertical";
  for (const unsigned seed : {31U, 32U, 33U}) {
    CAPTURE(seed);
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 200.0, .seed = seed, .effects = {truth}});
    Identifier identifier{settings(), vehicle};
    double next = 120.0;
    feed(identifier, dive.trial, 0.0, 1e9, [&](double t) {
      if (t < next) return;
      identifier.hear(accepted(next, found));
      next += 10.0;
    });
    const ModelEstimate model = identifier.model();
    CHECK(model.effects.empty());
    CHECK(identifier.rejected().contains("effect leaves a residual"));
  }
}

TEST_CASE("adoption: it takes several rankings in a row, and nothing happens where it is not wished") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const model::ActiveEffect gain = named(vehicle, "thruster_gain", {-0.4}, 1);
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 60.0, .seed = 3, .effects = {gain}});
  const auto after = [&](const IdentifierSettings& s, std::vector<EffectRanking> rankings) {
    Identifier identifier{s, vehicle};
    for (const EffectRanking& ranking : rankings) identifier.hear(ranking);
    feed(identifier, dive.trial, 0.0, 1e9);
    return identifier.model().effects.size();
  };
  const model::ActiveEffect other = named(vehicle, "thruster_gain", {-0.4}, 2);
  CHECK(after(settings(), {accepted(20, gain), accepted(30, gain)}) == 1);
  CHECK(after(settings(), {accepted(20, gain)}) == 0);
  CHECK(after(settings(), {accepted(20, gain), accepted(30, other)}) == 0);
  CHECK(after(settings(), {accepted(20, gain), accepted(30, gain, "ambiguous"), accepted(40, gain)}) == 0);
  CHECK(after(settings(), {accepted(20, gain), accepted(50, gain)}) == 1);
  IdentifierSettings never = settings();
  never.adopt_after = 0;
  CHECK(after(never, {accepted(20, gain), accepted(30, gain)}) == 0);
  // What nobody knows, what sensors do, and numbers that do not fit are not adopted.
  EffectRanking wrong = accepted(20, gain), again = accepted(30, gain);
  for (EffectRanking* r : {&wrong, &again}) r->candidates[0].name = "sea_monster";
  CHECK(after(settings(), {wrong, again}) == 0);
  for (EffectRanking* r : {&wrong, &again})
    r->candidates[0] = {.name = "thruster_gain", .variant = "nobody", .numbers = {0.1}};
  CHECK(after(settings(), {wrong, again}) == 0);
  for (EffectRanking* r : {&wrong, &again}) r->candidates[0] = {.name = "current", .numbers = {0.1}};
  CHECK(after(settings(), {wrong, again}) == 0);
}

TEST_CASE("adoption: an effect leaves when the diagnoser sees none and its size may be zero, and only then") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const model::ActiveEffect gain = named(vehicle, "thruster_gain", {-0.4}, 1);
  for (const bool there : {false, true}) {
    const test::VirtualDive dive = test::make_dive(
        vehicle,
        {.duration = 120.0, .seed = 6, .effects = there ? std::vector{gain} : std::vector<model::ActiveEffect>{}});
    Identifier identifier{settings(), vehicle};
    for (const double t : {60.0, 70.0}) identifier.hear(accepted(t, gain));
    feed(identifier, dive.trial, 0.0, 80.0);
    CHECK(identifier.adopted() != nullptr);
    for (const double t : {85.0, 95.0}) identifier.hear(accepted(t, gain, "adequate"));
    feed(identifier, dive.trial, 80.0, 1e9);
    CHECK((identifier.adopted() != nullptr) == there);
  }
}

TEST_CASE("adoption: the same bits whenever the rankings arrive within the delay") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const model::ActiveEffect gain = named(vehicle, "thruster_gain", {-0.4}, 1);
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 120.0, .seed = 4, .effects = {gain}});
  Identifier early{settings(), vehicle}, late{settings(), vehicle};
  feed(early, dive.trial, 0.0, 1e9, diagnoser(early, gain));
  feed(late, dive.trial, 0.0, 1e9, diagnoser(late, gain, 0.8));
  CHECK(early.save_text() == late.save_text());
  CHECK(early.adopted() != nullptr);
}

TEST_CASE("adoption: a process that was killed goes on with the effect") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const model::ActiveEffect gain = named(vehicle, "thruster_gain", {-0.4}, 1);
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 150.0, .seed = 5, .effects = {gain}});
  Identifier first{settings(), vehicle};
  feed(first, dive.trial, 0.0, 100.0, diagnoser(first, gain));
  REQUIRE(first.adopted() != nullptr);
  Identifier second{settings(), vehicle};
  second.offer(first.save_text(), 120.0);
  feed(second, dive.trial, 101.0, 1e9);
  CHECK(second.resumed());
  const ModelEstimate model = second.model();
  REQUIRE(model.effects == std::vector<std::string>{"thruster_gain"});
  CHECK(std::abs(model.effect_numbers[0].value + 0.4) < kSigmas * model.effect_numbers[0].std);
}
