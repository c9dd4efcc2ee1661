// Two effects that one motion cannot tell apart: a segment that can is named, and it does. An effect is never told from
// itself.
#include "common/planning/separation.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "common/base/config.hpp"
#include "common/model/rollout.hpp"
#include "common/model/site.hpp"
#include "common/planning/rehearsal.hpp"
#include "common/planning/segments.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::planning;

namespace {

constexpr double kWindow = 10.0;  // s

struct Range {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  RehearsalSettings settings;
  std::vector<std::unique_ptr<View>> views;
  std::vector<Extra> extras;
  Range() {
    const std::string root = FATHOM_SOURCE_DIR;
    const Config pipeline = Config::load(root + "/config/pipelines/tank.yaml");
    settings.supervisor = excitation::SupervisorSettings::from(pipeline.section("supervisor"), vehicle,
                                                               model::Site::load(root + "/config/sites/tank.yaml"));
    for (const excitation::Segment& segment : segments(vehicle, settings.supervisor.largest)) {
      views.push_back(std::make_unique<View>(vehicle, flight(segment), kWindow));
      extras.push_back({segment.name, segment.duration, views.back().get()});
    }
  }
  [[nodiscard]] Trial flight(const excitation::Segment& segment) const {
    return fly(vehicle, settings, segment, segment.duration + 0.1);
  }
};

}  // namespace

TEST_CASE("separation: the segment that is named tells look-alikes apart, and an effect is never told from itself") {
  const Range range;
  // Thrust ahead alone, and gently: a weak thruster on one side does what one at another place does.
  excitation::Segment ahead{.name = "ahead", .duration = 20.0};
  ahead.step[0] = 0.15;
  const View data{range.vehicle, range.flight(ahead), kWindow};
  const model::Scene scene = model::scene_of(range.vehicle, data.trials());
  const model::ActiveEffect weak = test::active("thruster_gain", {0.01}, 0);
  const model::Effect& shifted = *model::find_effect("thruster_misalignment");

  const std::optional<Answer> answer = segment_between(weak, shifted, scene, data, range.extras);
  REQUIRE(answer);
  CAPTURE(answer->segment);
  CHECK(answer->seconds >= 5.0);
  CHECK(answer->seconds < 600.0);
  CHECK_FALSE(segment_between(weak, *weak.effect, scene, data, range.extras));

  // Flown long enough with the data, it leaves the pair no longer open.
  std::vector<Extra> only;
  for (const Extra& extra : range.extras) {
    if (extra.name == answer->segment) only.push_back(extra);
  }
  REQUIRE(only.size() == 1);
  const std::optional<Answer> same = segment_between(weak, shifted, scene, data, only);
  REQUIRE(same);
  CHECK(same->seconds == doctest::Approx(answer->seconds));
}

TEST_CASE("separation: where nothing more can be flown there is no answer") {
  const Range range;
  excitation::Segment ahead{.name = "ahead", .duration = 20.0};
  ahead.step[0] = 0.15;
  const View data{range.vehicle, range.flight(ahead), kWindow};
  const model::Scene scene = model::scene_of(range.vehicle, data.trials());
  CHECK_FALSE(segment_between(test::active("thruster_gain", {0.01}, 0), *model::find_effect("thruster_misalignment"),
                              scene, data, {}));
}
