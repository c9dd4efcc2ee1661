// Which thruster of a pair has failed is asked again beside what was found later.
#include "common/diagnosis/reconsidered.hpp"

#include <doctest/doctest.h>

#include <random>
#include <string>
#include <vector>

#include "common/diagnosis/moments.hpp"
#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::TrajectoryFit;

namespace {

constexpr int kStarboard = 4, kPort = 5;  // vertical thrusters of the vehicle, side by side

struct Case {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  std::vector<std::string> names;
  SearchResult found;

  /// One of the two fails in a dive in which buoyancy changes with depth; the search has taken `accepted` for it.
  Case(int failed, int accepted, double share, unsigned seed) {
    const std::vector<Trial> trials{
        test::make_dive(vehicle, {.duration = 120.0,
                                  .dt = 0.04,
                                  .seed = seed,
                                  .velocity_noise = 0.002,
                                  .rate_noise = 0.002,
                                  .effects = {test::active("thruster_failure", {share, 60.0}, failed),
                                              test::active("compressibility", {2.0})}})
            .trial};
    const TrajectoryFit problem{vehicle, trials, {.window = 5.0}};
    const model::Scene scene = model::scene_of(vehicle, trials);
    found.before = problem.fit(model::nominal_model(vehicle, false));
    const model::Effect* failure = model::find_effect("thruster_failure");
    names = failure->variants(scene);
    const auto name = [&](int variant) { return names[static_cast<std::size_t>(variant)]; };
    model::Model model = model::nominal_model(vehicle, false);
    model.add({failure, accepted, name(accepted), {0.5 * share, 61.0}});
    model.add(test::active("compressibility", {1.0}));
    found.after = at_best_moment(problem, problem.fit(model, &found.before), *failure, accepted);
    found.accepted.push_back({.effect = failure,
                              .variant = accepted,
                              .variant_name = name(accepted),
                              .other_forms = {name(accepted == kPort ? kStarboard : kPort)}});
    found.accepted.push_back({.effect = model::find_effect("compressibility")});
    reconsider_forms(
        found, problem, scene, [](const std::string&, double) {}, 0.0);
  }
};

}  // namespace

TEST_CASE("reconsidered: the other thruster of a pair takes the place of the one that was taken for it") {
  if (!test::kTimed) return;
  std::mt19937_64 random{20261126};
  for (const int failed : {kStarboard, kPort}) {
    const double share = std::uniform_real_distribution<double>{0.5, 1.0}(random);
    CAPTURE(share);
    for (const int accepted : {kStarboard, kPort}) {
      CAPTURE(accepted == failed);
      const Case dive{failed, accepted, share, static_cast<unsigned>(random())};
      REQUIRE(dive.found.accepted.size() == 2);
      CHECK(dive.found.accepted[0].variant == failed);
      CHECK(dive.found.accepted[0].variant_name == dive.names[static_cast<std::size_t>(failed)]);
      CHECK(dive.found.accepted[0].other_forms.empty());
      REQUIRE(dive.found.after.model.effects.size() == 2);
      for (const model::ActiveEffect& active : dive.found.after.model.effects) {
        if (active.effect->name() != "thruster_failure") continue;
        CHECK(active.variant == failed);
        CHECK(active.theta[0] == doctest::Approx(share).epsilon(0.05));
      }
    }
  }
}

TEST_CASE("reconsidered: the effect that was found last is not asked, since nothing has changed for it") {
  SearchResult found;
  found.accepted.push_back({.effect = model::find_effect("thruster_failure"), .other_forms = {"T1"}});
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const std::vector<Trial> trials{test::make_dive(vehicle, {.duration = 20.0, .dt = 0.1}).trial};
  const TrajectoryFit problem{vehicle, trials, {.window = 5.0}};
  bool asked = false;
  reconsider_forms(
      found, problem, model::scene_of(vehicle, trials), [&](const std::string&, double) { asked = true; }, 0.0);
  CHECK_FALSE(asked);
  CHECK(found.accepted[0].other_forms.size() == 1);
}
