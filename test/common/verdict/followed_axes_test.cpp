#include "common/verdict/followed_axes.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "common/estimation/split.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::verdict;

TEST_CASE("followed axes: where thrust acts and what no fit has seen is foretold better than by simpler rules") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = test::fly(vehicle, {.duration = 200.0, .seed = 3});
  const estimation::Parts parts = estimation::split(dive.trial, 0.5, estimation::Kept::kLast);
  inference::Conclusion conclusion;
  conclusion.reported.hypothesis.model = conclusion.reported_base.hypothesis.model = dive.truth;
  const auto followed = [&](const Trial& train, int axis) {
    const std::vector<int> axes = skilled_axes(vehicle, {&train, 1}, parts.judged, dive.trial.input_step, conclusion);
    return std::ranges::find(axes, axis) != axes.end();
  };
  for (const int axis : {0, 1, 2}) {
    CAPTURE(axis);
    CHECK(followed(parts.fitted, axis));
  }
  Trial idle = parts.fitted;
  for (auto& input : idle.input) input.setZero();
  for (int axis = 0; axis < 6; ++axis) CHECK_FALSE(followed(idle, axis));  // nothing shows thrust to act
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&parts.fitted, 1});
  likelihood::Hypothesis& wrong = conclusion.reported.hypothesis;
  wrong.runs.resize(1);
  const std::vector<likelihood::Number> numbers = problem.numbers(wrong);
  const auto mass = std::ranges::find(numbers, "m_X", &likelihood::Number::name);
  REQUIRE(mass != numbers.end());
  at(wrong, *mass) *= 10.0;
  conclusion.reported_base.hypothesis = wrong;
  CHECK_FALSE(followed(parts.fitted, 0));  // an equation of surge alone foretells it better
}
