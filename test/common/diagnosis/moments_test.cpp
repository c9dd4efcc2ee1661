// A fit that ended at a wrong moment is brought to the right one.
#include "common/diagnosis/moments.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using identification::FitResult;
using identification::TrajectoryFit;

namespace {

constexpr double kTrueMoment = 61.3;      // s
constexpr double kMomentError = 0.3;      // s: how long the change itself is taken to last
constexpr double kWeight = 4.0;           // N, plainly visible on this vehicle
constexpr double kSmallMassChange = 0.4;  // kg

}  // namespace

TEST_CASE("moments: a payload's moment that lies far off is found, and the fit becomes better") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 120.0,
                                .seed = 77,
                                .spread = 0.0,
                                .effects = {test::active("payload_change", {kSmallMassChange, kWeight, kTrueMoment})}});
  const std::vector<Trial> trials{dive.trial};
  const TrajectoryFit problem{vehicle, trials, {.window = 5.0, .threads = 1, .iterations = 8}};
  int lost = 0;
  for (const double astray_by : {25.0, -25.0, -40.0}) {  // s, from where not every fit finds its way downhill
    CAPTURE(astray_by);
    model::Model model = model::nominal_model(vehicle, false);
    model.add(test::active("payload_change", {kSmallMassChange, kWeight, kTrueMoment + astray_by}));
    const FitResult astray = problem.fit(model, nullptr);
    const model::ActiveEffect& payload = astray.model.effects.front();
    const bool ended_astray = std::abs(payload.theta[2] - kTrueMoment) > kMomentError;
    lost += ended_astray ? 1 : 0;
    const FitResult mended = diagnosis::at_best_moment(problem, astray, *payload.effect, payload.variant);
    CHECK(mended.cost <= astray.cost);
    if (ended_astray) CHECK(mended.cost < astray.cost);
    CHECK(std::abs(mended.model.effects.front().theta[2] - kTrueMoment) < kMomentError);
  }
  CHECK(lost > 0);
}

TEST_CASE("moments: an effect without a moment is left as it is") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(
      vehicle, {.duration = 60.0, .seed = 78, .spread = 0.0, .effects = {test::active("current", {0.08, -0.05})}});
  const std::vector<Trial> trials{dive.trial};
  const TrajectoryFit problem{vehicle, trials, {.window = 5.0, .threads = 1, .iterations = 8}};
  model::Model model = model::nominal_model(vehicle, false);
  model.add(test::active("current", {0.05, -0.05}));
  const FitResult fit = problem.fit(model, nullptr);
  const model::ActiveEffect& current = fit.model.effects.front();
  const FitResult same = diagnosis::at_best_moment(problem, fit, *current.effect, current.variant);
  CHECK(same.cost == fit.cost);
  CHECK(same.model.effects.front().theta == current.theta);
}
