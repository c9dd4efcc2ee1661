// What is promised before a trial is kept after it: sizes above the smallest are found in noisy data, sizes well below
// are not, and what cannot be told apart says so.
#include "common/planning/foresight.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>

#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::planning;

namespace {

constexpr double kDuration = 200.0;  // s
constexpr double kWindow = 10.0;     // s

test::DiveSettings settings(double noise) {
  return {.duration = kDuration, .seed = 5, .velocity_noise = noise, .rate_noise = noise, .spread = 0.0};
}

Trial clean(const model::Vehicle& vehicle) {
  Trial trial = test::make_dive(vehicle, settings(0.0)).trial;
  trial.nu_sigma.setConstant(0.005);
  return trial;
}

const Foreseen& named(const std::vector<Foreseen>& all, const std::string& name) {
  const auto place = std::ranges::find(all, name, &Foreseen::name);
  REQUIRE(place != all.end());
  return *place;
}

bool found_at(const model::Vehicle& vehicle, const Foreseen& promise, double factor) {
  std::vector<double> theta;
  for (const NamedValue& number : promise.size) theta.push_back(factor * number.value);
  test::DiveSettings dive = settings(0.005);
  dive.effects = {test::active(promise.name, theta)};
  const std::vector<Trial> trials{test::make_dive(vehicle, dive).trial};
  const inference::Conclusion answer = inference::infer(vehicle, trials, {}, {});
  return std::ranges::find(answer.found.best.names, promise.name) != answer.found.best.names.end();
}

}  // namespace

TEST_CASE("foresight: promises about sizes are kept, and look-alikes are named") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const View view{vehicle, clean(vehicle), kWindow};
  const View again{vehicle, clean(vehicle), kWindow};
  const std::vector<Extra> extras{{"the same again", kDuration, &again}};
  std::atomic<double> expected{0.0}, told{0.0};
  const Progress progress{[&](const Progress::Event& event) {
    if (event.kind == Progress::Event::Kind::kExpect) expected = event.units;
    if (event.kind == Progress::Event::Kind::kDone) told += event.units;
  }};
  const std::vector<Foreseen> all = foresee(vehicle, view, extras, {}, progress);
  CHECK(expected.load() > 10.0);
  CHECK(told.load() == expected.load());

  const Foreseen& current = named(all, "current");
  REQUIRE(current.found);
  CHECK(current.hidden < 0.2);
  CHECK(found_at(vehicle, current, 3.0));
  if (test::kTimed) CHECK_FALSE(found_at(vehicle, current, 0.2));
  // The same again brings the same once more.
  REQUIRE(current.soonest);
  CHECK(current.soonest->seconds == doctest::Approx(kDuration).epsilon(0.05));

  // Noisier sensors, and commands at 50 Hz: what shows at all is more than what matters, and evidence decides.
  test::DiveSettings often = settings(0.0);
  often.dt = often.step = 0.02;
  Trial noisy = test::make_dive(vehicle, often).trial;
  noisy.nu_sigma.setConstant(0.03);
  const std::vector<Foreseen> by_evidence = foresee(vehicle, View{vehicle, noisy, kWindow}, {}, {}, {});
  const Foreseen& delay = named(by_evidence, "thruster_delay");
  CHECK(std::ranges::any_of(delay.like, [](const LookAlike& other) { return other.name == "thruster_lag"; }));
  for (const Foreseen& one : all) {
    CAPTURE(one.name);
    CHECK(one.forms >= one.forms_found);
    if (!one.found) continue;
    CHECK(one.hidden >= 0.0);
    CHECK(one.hidden <= 1.0);
    CHECK_FALSE(one.size.empty());
    CHECK_FALSE(one.corrupted.empty());
  }
}

TEST_CASE("foresight: what a parameter can imitate hides in that parameter") {
  // Buoyancy that falls with depth is, while the depth changes little, a change of W-B.
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  Trial trial = clean(vehicle);
  for (Eigen::Vector3d& p : trial.p_WB) p.z() = 3.0 + 0.1 * p.z();
  const View view{vehicle, trial, kWindow};
  const std::vector<Foreseen> all = foresee(vehicle, view, {}, {}, {});
  const Foreseen& compressibility = named(all, "compressibility");
  REQUIRE(compressibility.found);
  CHECK(compressibility.hidden > 0.8);
  CHECK(compressibility.corrupted == "W-B");
  const Foreseen& asymmetric = named(all, "asymmetric_drag");
  CHECK(asymmetric.found);
  CHECK(asymmetric.hidden < 0.5);
  CHECK_FALSE(asymmetric.soonest.has_value());  // nothing to choose from
}

TEST_CASE("foresight: quiet data show a lag shorter than steps of time, and it is promised at what they can hold") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  Trial trial = clean(vehicle);
  trial.nu_sigma.setConstant(1e-3);
  // However small it is: a diagnosis asks for a size that matters besides.
  const inference::Settings settings{.thresholds = {.smallest_size = 1e-3}};
  const std::vector<Foreseen> all = foresee(vehicle, View{vehicle, trial, kWindow}, {}, settings, {});
  const Foreseen& lag = named(all, "thruster_lag");
  REQUIRE(lag.found);
  CHECK(lag.size[0].value > 1e-3);  // s: a twentieth of the longest step
  CHECK(lag.size[0].value < 0.01);
}

TEST_CASE("view: an effect's change has what the initial velocity can do taken out") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const View view{vehicle, clean(vehicle), kWindow};
  const Eigen::VectorXd once = view.change(test::active("current", {0.001, 0.0}));
  const Eigen::VectorXd twice = view.change(test::active("current", {0.002, 0.0}));
  CHECK((twice - 2.0 * once).norm() < 0.02 * twice.norm());  // small changes are proportional
  CHECK(view.change(test::active("current", {0.0, 0.0})).norm() < 1e-9);
  CHECK(view.jacobian().rows() == once.size());
}
