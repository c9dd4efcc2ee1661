// The last fit keeps the windows that were asked for, and shortens them where they lead away from what short ones say.
#include "common/diagnosis/final_fit.hpp"

#include <doctest/doctest.h>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

struct Dive {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 120.0, .seed = 21, .spread = 0.0});
  std::vector<Trial> trials{dive.trial};
  Settings settings;
  model::Model start = model::nominal_model(vehicle, false);
};

}  // namespace

TEST_CASE("final fit: a vehicle that long windows suit keeps them") {
  const Dive d;
  NearView near{d.vehicle, d.trials, d.settings};
  near.fit(d.start);
  const Everything all = fit_everything(d.vehicle, d.trials, d.settings, near, d.start);
  CHECK(all.problem.settings().window == d.settings.fit.window);
  CHECK(all.fit.cost > 0.0);
}

TEST_CASE("final fit: windows are shortened, down to the shortest, while they leave what short ones do not need") {
  const Dive d;
  NearView near{d.vehicle, d.trials, d.settings};
  near.fit(d.start);
  near.reference.cost *= 1e-3;  // as if short windows fitted far better than any long one ever could
  const Everything all = fit_everything(d.vehicle, d.trials, d.settings, near, d.start);
  CHECK(all.problem.settings().window == near.problem.settings().window);
}
