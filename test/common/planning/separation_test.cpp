// Two effects that one motion cannot tell apart: a segment that can is named, and it does. An effect is never told from
// itself.
#include "common/planning/separation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/config.hpp"
#include "common/excitation/segments.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/rollout.hpp"
#include "common/model/site.hpp"
#include "common/planning/flights.hpp"
#include "common/planning/live_separation.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::planning;

namespace {

constexpr double kWindow = 10.0;  // s

/// Thrust ahead alone, and gently: a weak thruster on one side does what one at another place does.
struct Ahead {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  RehearsalSettings settings;
  std::optional<View> data;
  model::Scene scene;
  model::ActiveEffect weak = test::active("thruster_gain", {0.01}, 0);
  const model::Effect& shifted = *model::find_effect("thruster_misalignment");
  Ahead() {
    const std::string root = FATHOM_SOURCE_DIR;
    const Config pipeline = Config::load(root + "/config/pipelines/tank.yaml");
    settings.supervisor = excitation::SupervisorSettings::from(pipeline.section("supervisor"), vehicle,
                                                               model::Site::load(root + "/config/sites/tank.yaml"));
    excitation::Segment ahead{.name = "ahead", .duration = 20.0};
    ahead.step[0] = 0.15;
    data.emplace(vehicle, fly(vehicle, model::nominal_model(vehicle, false), false, settings, ahead, ahead.duration),
                 kWindow);
    scene = model::scene_of(vehicle, data->trials());
  }
};

}  // namespace

TEST_CASE("separation: the segment that is named tells look-alikes apart, and an effect is never told from itself") {
  const Ahead ahead;
  const Flights flights{ahead.vehicle, *ahead.data, ahead.settings};
  const auto answer = segment_between(ahead.weak, ahead.shifted, ahead.scene, *ahead.data, flights.extras());
  REQUIRE(answer);
  CAPTURE(answer->segment);
  CHECK(answer->seconds >= 5.0);
  CHECK(answer->seconds < 600.0);
  CHECK_FALSE(segment_between(ahead.weak, *ahead.weak.effect, ahead.scene, *ahead.data, flights.extras()));

  // Alone it answers as soon as among the others.
  const auto named = std::ranges::find(flights.extras(), answer->segment, &Extra::name);
  REQUIRE(named != flights.extras().end());
  const auto same = segment_between(ahead.weak, ahead.shifted, ahead.scene, *ahead.data, {&*named, 1});
  REQUIRE(same);
  CHECK(same->seconds == doctest::Approx(answer->seconds));
}

TEST_CASE("separation: where nothing more can be flown there is no answer") {
  const Ahead ahead;
  CHECK_FALSE(segment_between(ahead.weak, ahead.shifted, ahead.scene, *ahead.data, {}));
}

TEST_CASE("separation: while a trial runs, the identifier's parameters and two suspects are enough") {
  const Ahead ahead;
  const LiveSeparation live{ahead.vehicle, ahead.settings};
  ModelEstimate known;
  for (std::size_t i = 0; i < ahead.vehicle.parameters.size(); ++i) {
    const double mean = ahead.vehicle.priors[i].mean;
    known.parameters.push_back({ahead.vehicle.parameters[i], mean, 0.01 * std::abs(mean) + 0.01, ""});
  }
  model::ActiveEffect weak = ahead.weak, strong = ahead.weak;
  weak.theta = {-0.1};
  strong.theta = {-0.4};
  const std::vector<std::string> forms = ahead.shifted.variants(ahead.scene);
  const auto form = std::ranges::find_if(forms, [](const std::string& name) { return name != "-"; });
  REQUIRE(form != forms.end());
  const model::ActiveEffect shifted =
      test::active("thruster_misalignment", {0.02}, static_cast<int>(form - forms.begin()));
  const auto answer = live.between(weak, shifted, known);
  REQUIRE(answer);
  CHECK(excitation::segment_named(answer->segment, ahead.vehicle, ahead.settings.supervisor.largest));
  CHECK(answer->seconds >= 20.0);
  CHECK_FALSE(live.between(weak, weak, known));
  // What is four times as large shows sooner, or as soon as anything can.
  const auto sooner = live.between(strong, shifted, known);
  REQUIRE(sooner);
  CHECK(sooner->seconds <= answer->seconds);
}
