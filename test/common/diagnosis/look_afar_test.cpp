// What is far from absence is found also where the base numbers have gone far astray beside it.
#include "common/diagnosis/look_afar.hpp"

#include <doctest/doctest.h>

#include <random>

#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

TEST_CASE("look afar: a pendulum is found beside inertias that have grown and drag that has vanished without it") {
  const model::Vehicle vehicle = test::without_parameters(test::vehicle_from_repository("beluga"), "G_");
  constexpr int kAll = 7;  // G_x, G_y, G_z
  std::mt19937 random{1299};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    const double G_z = 30.0 + 10.0 * any(random);  // N m
    const test::VirtualDive dive = test::make_dive(
        vehicle, {.duration = 160.0,
                  .seed = seed,
                  .wrench = true,
                  .effects = {test::active("restoring_moment", {3.0 * any(random), 3.0 * any(random), G_z}, kAll)}});
    const std::span<const Trial> trials{&dive.trial, 1};
    const identification::TrajectoryFit problem{vehicle, trials, {}};
    model::Model astray = model::nominal_model(vehicle, true);
    for (const Eigen::Index turn : {3, 4}) {
      astray.theta[turn] *= 15.0;
      astray.theta[6 + turn] = astray.theta[12 + turn] = 0.0;
    }
    const identification::FitResult fit = problem.fit(astray);
    const model::Effect* pendulum = model::find_effect("restoring_moment");
    const Screened screened{.effect = pendulum, .variant = kAll, .theta = {0.0, 0.0, 0.0}, .base = fit.model};
    Answers answers{.near = {screened},
                    .screened = {screened},
                    .share = {0.0},
                    .judged = {Judged{.effect = pendulum, .variant = kAll}},
                    .fitted = {true},
                    .found = {std::nullopt}};
    look_afar(
        answers, problem, trials, {}, fit, model::scene_of(vehicle, trials), [](const std::string&, double) {}, 0.0);
    REQUIRE(answers.found[0].has_value());
    CHECK_FALSE(answers.fitted[0]);
    CHECK(answers.share[0] > 0.5);
    // A full fit follows; from within a fifth it has no valley to cross.
    CHECK(answers.found[0]->effects[0].theta[2] == doctest::Approx(G_z).epsilon(0.2));
  }
}
