#include "common/verdict/followed_axes.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::verdict;

TEST_CASE(
    "followed axes: those on which thrust acts and whose unseen motion the model foretells better than simpler rules") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = test::fly(vehicle, {.duration = 150.0, .seed = 3});
  inference::Conclusion conclusion;
  conclusion.reported.hypothesis.model = conclusion.reported_base.hypothesis.model = dive.truth;
  const auto skilled = [&](const Trial& train) {
    return skilled_axes(vehicle, {&train, 1}, {&dive.trial, 1}, dive.trial.input_step, conclusion);
  };
  for (int axis = 0; axis < 6; ++axis) {
    CAPTURE(axis);
    const std::vector<int> axes = skilled(dive.trial);
    CHECK((std::ranges::find(axes, axis) != axes.end()) == vehicle.dof[static_cast<std::size_t>(axis)]);
  }
  Trial idle = dive.trial;
  for (auto& input : idle.input) input.setZero();
  CHECK(skilled(idle).empty());  // numbers that are right by chance, of axes that nothing shows thrust to act on
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  likelihood::Hypothesis& wrong = conclusion.reported.hypothesis;
  wrong.runs.resize(1);
  const std::vector<likelihood::Number> numbers = problem.numbers(wrong);
  const auto mass = std::ranges::find(numbers, "m_X", &likelihood::Number::name);
  REQUIRE(mass != numbers.end());
  at(wrong, *mass) *= 10.0;
  conclusion.reported_base.hypothesis = wrong;
  const std::vector<int> axes = skilled(dive.trial);
  CHECK(std::ranges::find(axes, 0) == axes.end());  // an equation of surge alone foretells it better
  CHECK_FALSE(axes.empty());
}
