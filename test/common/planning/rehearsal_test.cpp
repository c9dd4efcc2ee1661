// A trial flown in advance by the real supervisor: it comes to its end, stays inside the fence, and moves every axis.
#include "common/planning/rehearsal.hpp"

#include <doctest/doctest.h>

#include <set>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/excitation/segments.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/site.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::planning;

namespace {

struct Tank {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  RehearsalSettings settings;
  Tank() {
    const std::string root = FATHOM_SOURCE_DIR;
    const model::Site site = model::Site::load(root + "/config/sites/tank.yaml");
    const Config pipeline = Config::load(root + "/config/pipelines/tank.yaml");
    settings.supervisor = excitation::SupervisorSettings::from(pipeline.section("supervisor"), vehicle, site);
    settings.identifier = identification::IdentifierSettings::from(pipeline.section("identifier"));
  }
  void check_inside(const Trial& trial) const {
    const excitation::FenceSettings& fence = settings.supervisor.fence;
    for (const Eigen::Vector3d& p : trial.p_WB) {
      CHECK(((p - fence.low).array() > -fence.hard).all());
      CHECK(((fence.high - p).array() > -fence.hard).all());
    }
  }
};

Vector6d rms(const Trial& trial) {
  Vector6d square = Vector6d::Zero();
  for (const Vector6d& nu : trial.nu) square += nu.cwiseAbs2();
  return (square / static_cast<double>(trial.size())).cwiseSqrt();
}

}  // namespace

TEST_CASE("rehearsal: the paper's schedule comes to its end inside the fence") {
  const Tank tank;
  const Rehearsal rehearsal = rehearse(tank.vehicle, tank.settings);
  CHECK(rehearsal.visits.size() == tank.settings.supervisor.schedule.size());
  CHECK(rehearsal.trial.t.back() < tank.settings.longest);
  tank.check_inside(rehearsal.trial);
  const Vector6d moved = rms(rehearsal.trial);
  for (const int axis : {0, 1, 2, 5}) CHECK(moved[axis] > 0.05);
  // Fewer samples than the vehicle will have, each so much better.
  CHECK(rehearsal.trial.nu_sigma[0] == doctest::Approx(0.005 / std::sqrt(5.0)));
}

TEST_CASE("rehearsal: what ends as soon as it begins is said") {
  Tank tank;
  tank.settings.longest = 5.0;
  CHECK_THROWS_AS(static_cast<void>(rehearse(tank.vehicle, tank.settings)), InputError);
}

TEST_CASE("segments: each has a name of its own, moves what it names, and stays inside") {
  const Tank tank;
  std::set<std::string> names;
  for (const excitation::Segment& segment : excitation::segments(tank.vehicle, tank.settings.supervisor.largest)) {
    CAPTURE(segment.name);
    CHECK(names.insert(segment.name).second);
    const Trial trial =
        fly(tank.vehicle, model::nominal_model(tank.vehicle, false), false, tank.settings, segment, segment.duration);
    CHECK(trial.t.back() == doctest::Approx(segment.duration).epsilon(0.01));
    tank.check_inside(trial);
    const Vector6d moved = rms(trial);
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (segment.step[axis] != 0.0 || !segment.amplitude.row(axis).isZero()) CHECK(moved[axis] > 0.01);
    }
  }
  CHECK(names.size() > 10);
}
