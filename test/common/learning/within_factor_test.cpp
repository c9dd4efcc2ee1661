// Numbers inside a factor: what is possible, what follows from them, and that they are found from a wrong beginning.
#include "common/learning/within_factor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "common/learning/profile_inner.hpp"
#include "common/model/learned/factors/factor_kind.hpp"
#include "test/common/learning/learned_case.hpp"

using namespace fathom;
using namespace fathom::learning;
using model::Factor;
using model::Quantity;

TEST_CASE("within factor: an edge that turns is where the box ends, and no reach is longer than half of it") {
  const test::LearnedCase dive{{.duration = 40.0, .seed = 2}, false};
  const Room room{dive.problem};
  for (const double bearing : {0.3, 1.9, 4.0, 2.0 * std::numbers::pi}) {
    Factor near{.quantity = Quantity::kNear, .index = 0, .a = 1e3, .b = 1e3, .c = bearing};
    settle(near, room);
    double most = -1e300, width = 0.0;
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        const double along = std::cos(bearing) * (room.middle[1] + x * room.half[1]) +
                             std::sin(bearing) * (room.middle[2] + y * room.half[2]);
        most = std::max(most, along);
        width = std::max(width,
                         2.0 * std::abs(std::cos(bearing) * x * room.half[1] + std::sin(bearing) * y * room.half[2]));
      }
    }
    CHECK(near.a == doctest::Approx(most));
    CHECK(near.b == doctest::Approx(0.5 * width));
    CHECK(inner_of(near, room).size() == 2);
  }
  Factor below{.quantity = Quantity::kNear, .index = 1, .b = 0.1, .c = 1.0};
  CHECK(inner_of(below, room).size() == 1);  // it has no bearing
  Factor line{.quantity = Quantity::kStretch, .d = -2.0};
  settle(line, room);
  CHECK(line.d == 0.0);
  CHECK(inner_of(line, room).size() == 4);
  Factor hanging{.quantity = Quantity::kPlanStretch, .d = -2.0};
  settle(hanging, room);
  CHECK(hanging.d == 0.0);
  CHECK(inner_of(hanging, room).size() == 3);  // it has no depth
  Factor bend{.quantity = Quantity::kThrustBelow, .a = -2.0};
  settle(bend, room);
  CHECK(bend.a > 0.0);
  CHECK(inner_of(bend, room).size() == 1);
  Factor slow{.quantity = Quantity::kSettling, .b = 1e6};
  settle(slow, room);
  CHECK(slow.b == doctest::Approx(4.0 * room.half[0]));  // slower is a straight line
  CHECK(inner_of(slow, room).size() == 1);
  CHECK_FALSE(has_inner({.quantity = Quantity::kDepth}));
}

TEST_CASE("within factor: a pull is moved to its point from the other side of the water, beside a fitted model") {
  const Eigen::Vector3d end{2.0, 3.0, -1.0};
  const double slack = 2.0, stiffness = 3.0;  // m, N/m
  const std::vector<double> theta{stiffness, slack, end.x(), end.y(), end.z(), 0.0, 0.0, 0.0};
  test::NoisyDive settings{.duration = 120.0, .seed = 7, .force = 0.005};
  settings.effects = {{.effect = model::find_effect("tether_tension"), .variant = 0, .theta = theta}};
  const test::LearnedCase dive{settings, false};
  const Room room{dive.problem};
  const inference::Seen seen = inference::see(dive.problem, dive.conclusion.found.best.fit, 2);
  const model::Scene scene = model::scene_of(test::bluerov(), {&dive.trial, 1});
  model::Feature pull{.axis = model::kPull, .count = 1};
  pull.factors[0] = {.quantity = Quantity::kStretch, .a = -1.0, .b = 1.0, .c = 0.5, .d = 1.0};
  likelihood::FreeForce library{
      .features = {pull}, .groups = {{.axis = model::kPull, .count = 1, .closed = true}}, .weights = {0.0}};
  const auto found = profile_inner(dive.problem, seen, scene, room, {0}, library, 1);
  REQUIRE(found.size() == 1);
  CHECK(found.front().second > 100.0);  // nats
  // The same pull at the places where it was, within a tenth: point and length trade with each other.
  const Factor& moved = library.features.front().factors[0];
  model::FeatureState state;
  double dot = 0.0, ours = 0.0, truth = 0.0, error = 0.0;
  for (const Eigen::Vector3d& p : dive.trial.p_WB) {
    state.p_WB = p;
    const auto force = [&](const Factor& line) {
      return Eigen::Vector3d{model::kind_of(Quantity::kStretch).value(line, state) *
                             (Eigen::Vector3d{line.a, line.b, line.c} - p).normalized()};
    };
    const Eigen::Vector3d of_ours = force(moved),
                          of_truth = force({.a = end.x(), .b = end.y(), .c = end.z(), .d = slack});
    dot += of_ours.dot(of_truth);
    ours += of_ours.squaredNorm();
    truth += of_truth.squaredNorm();
  }
  error = std::sqrt(std::max(0.0, 1.0 - dot * dot / (ours * truth)));  // sine of the angle between them
  MESSAGE("point " << moved.a << " " << moved.b << " " << moved.c << ", length " << moved.d << ", off by " << error);
  CHECK(error < 0.1);
}
