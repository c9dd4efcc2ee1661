// A dive whose dead band acts before or behind another change of thrust, as a seed will have it.
#include "common/diagnosis/acting_order.hpp"

#include <doctest/doctest.h>

#include <random>
#include <string>
#include <vector>

#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::TrajectoryFit;

namespace {

struct Pair {
  model::ActiveEffect moved, other;  // as they act in the dive
};

struct Case {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  SearchResult found;
  int asked{0};

  /// The search has accepted both, in the registry's order.
  Case(const Pair& pair, unsigned seed) {
    const std::vector<Trial> trials{test::make_dive(vehicle, {.duration = 120.0,
                                                              .dt = 0.04,
                                                              .seed = seed,
                                                              .velocity_noise = 0.002,
                                                              .rate_noise = 0.002,
                                                              .effects = {pair.moved, pair.other}})
                                        .trial};
    const TrajectoryFit problem{vehicle, trials, {.window = 5.0}};
    found.before = problem.fit(model::nominal_model(vehicle, false));
    model::Model model = model::nominal_model(vehicle, false);
    for (model::ActiveEffect active : {pair.moved, pair.other}) {
      active.last = false;
      found.accepted.push_back({.effect = active.effect, .variant = active.variant});
      model.add(active);
    }
    found.after = problem.fit(model, &found.before);
    reconsider_order(
        found, problem, [this](const std::string&, double) { ++asked; }, 0.0);
  }

  [[nodiscard]] const model::ActiveEffect& named(const std::string& name) const {
    for (const model::ActiveEffect& active : found.after.model.effects) {
      if (active.effect->name() == name) return active;
    }
    throw std::runtime_error(name);
  }
};

}  // namespace

TEST_CASE("acting order: a dead band is found where it acts, with its numbers") {
  if (!test::kTimed) return;
  std::mt19937_64 random{20261126};
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  };
  for (const bool last : {false, true}) {
    CAPTURE(last);
    const double half = between(2.0, 4.0), change = between(-0.5, -0.3), lag = between(0.2, 0.4);
    model::ActiveEffect band = test::active("thruster_deadband", {half});
    band.last = last;
    for (const auto& [name, number] : {std::pair{"thrust_asymmetry", change}, std::pair{"thruster_lag", lag}}) {
      CAPTURE(std::string(name));
      const Case dive{{band, test::active(name, {number})}, static_cast<unsigned>(random())};
      CHECK(dive.named("thruster_deadband").last == last);
      CHECK(dive.named("thruster_deadband").theta[0] == doctest::Approx(half).epsilon(0.03));
      CHECK(dive.named(name).theta[0] == doctest::Approx(number).epsilon(0.03));
    }
  }
}

TEST_CASE("acting order: nothing is asked where the order is nothing to the thrust") {
  const Case dive{{test::active("thruster_gain", {-0.3}, 2), test::active("thruster_lag", {0.2})}, 3};
  CHECK(dive.asked == 0);
  const Case alone{{test::active("thruster_deadband", {2.0}), test::active("current", {0.1, 0.1})}, 4};
  CHECK(alone.asked == 0);
}

TEST_CASE("acting order: alone, nothing acts on what others leave") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  model::Model model = model::nominal_model(vehicle, false);
  model::ActiveEffect band = test::active("thruster_deadband", {2.0});
  band.last = true;
  const Judged judged{.effect = band.effect, .variant = band.variant};
  model.add(band);
  model.add(test::active("current", {0.1}));
  CHECK_FALSE(acts_last(model, judged));
  model.add(test::active("thruster_lag", {0.1}));
  CHECK(acts_last(model, judged));
}

TEST_CASE("acting order: what acts last stands behind all that change the thrust, before the water") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  model::Model model = model::nominal_model(vehicle, false);
  model::ActiveEffect band = test::active("thruster_deadband", {2.0});
  band.last = true;
  for (const char* name : {"current", "thruster_lag"}) model.add(test::active(name, {0.1}));
  model.add(band);
  for (const char* name : {"thrust_overshoot", "wave", "thruster_delay"}) model.add(test::active(name, {0.1}));
  std::vector<std::string> order;
  for (const model::ActiveEffect& active : model.effects) order.emplace_back(active.effect->name());
  CHECK(order == std::vector<std::string>{"thruster_delay", "thruster_lag", "thrust_overshoot", "thruster_deadband",
                                          "current", "wave"});
}
