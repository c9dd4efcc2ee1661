// Deviations of a model that lacks something, and of an axis that has hardly moved.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <random>

#include "common/identification/identifier.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr Utime kStart = 1'600'000'000'000'000;
constexpr double kMass = 10.0, kDrag = -15.0;  // kg, N/(m/s)

model::Vehicle slider() {
  model::Vehicle v;
  v.name = "slider";
  v.dof = {true, true, false, false, false, false};
  v.allocation = Eigen::Matrix<double, 6, Eigen::Dynamic>::Identity(6, 6);
  v.parameters = {"m_X", "X_u", "m_Y", "Y_v"};
  v.priors.assign(4, {.mean = 0.0, .sigma = 10.0});
  return v;
}

/// Two axes of the same mass and drag under the thrust that each is told, of which `applied` says what it does.
Identifier learnt(double seconds, const std::function<double(int axis, double t)>& told,
                  const std::function<double(int axis, double told)>& applied) {
  IdentifierSettings settings;
  settings.window = 1.0;
  settings.stride = 0.25;
  settings.noise_force = 0.1;
  settings.noise_acceleration = 0.015;
  settings.interpolate_input = false;
  settings.from_zero = true;
  Identifier identifier{settings, slider()};
  std::mt19937 engine{7};
  std::normal_distribution<double> normal{0.0, 0.006};
  constexpr double kStep = 0.01;
  Eigen::Vector2d speed = Eigen::Vector2d::Zero();
  for (int i = 0; i < static_cast<int>(seconds / kStep); ++i) {
    const Utime utime = utime_after(kStart, kStep * i);
    StateEstimate state{.utime = utime, .valid = true};
    Thrusters thrusters{.utime = utime, .has_tau = true};
    for (int axis = 0; axis < 2; ++axis) {
      const double force = told(axis, kStep * i);
      state.nu[axis] = speed[axis] + normal(engine);
      thrusters.tau[static_cast<Eigen::Index>(axis)] = force;
      const double reached = applied(axis, force) / -kDrag;
      speed[axis] = reached + (speed[axis] - reached) * std::exp(kDrag / kMass * kStep);
    }
    (void)identifier.step(thrusters);
    (void)identifier.step(state);
  }
  return identifier;
}

double driven(int, double t) { return 6.0 * std::sin(0.9 * t) + 4.0 * std::sin(2.3 * t); }

double off(const ModelEstimate& model, std::size_t parameter) {
  const NamedValue& p = model.parameters[parameter];
  return (p.value - (parameter % 2 == 0 ? kMass : kDrag)) / p.std;
}

}  // namespace

TEST_CASE("misfit: by hand, what is missing bends a parameter by its share of what is known, however long it goes on") {
  Misfit misfit{2};
  Row row{.axis = 0, .h = ParameterVector::Zero(2), .y = 0.0, .variance = 4.0};
  row.h << 2.0, 0.0;
  for (int i = 0; i < 100; ++i) misfit.take(row, 5.0, i >= 50);
  row.axis = 1;
  row.h << 1.0, 1.0;
  for (int i = 0; i < 100; ++i) misfit.take(row, 0.5, false);
  CHECK(misfit.excess()[0] == doctest::Approx(200.0));  // fifty times 5 - 1
  CHECK(misfit.excess()[1] == 0.0);
  ParameterMatrix nominal(2, 2);
  nominal << 0.01, 0.002, 0.002, 0.04;
  const ParameterMatrix bend = misfit.bend(nominal);
  CHECK(bend(0, 0) == doctest::Approx(0.01 * 200.0 * 100.0 / 125.0));  // information 100 on X, 25 on Y
  CHECK(bend(0, 1) == 0.0);
  CHECK(bend(1, 1) == 0.0);
  misfit.forget(0.5);
  CHECK(misfit.bend(nominal)(0, 0) == doctest::Approx(0.5 * bend(0, 0)));
}

TEST_CASE("misfit: thrust that is stronger ahead than astern bends a mass, and the deviation says so") {
  const auto honest = [](int, double told) { return told; };
  const auto uneven = [](int axis, double told) { return axis == 0 && told > 0.0 ? 1.4 * told : told; };
  const ModelEstimate right = learnt(120.0, driven, honest).model(), wrong = learnt(120.0, driven, uneven).model();
  CHECK(right.residual_excess.isZero(0.0));
  CHECK(wrong.residual_excess[0] > 1000.0);
  CHECK(wrong.residual_excess[1] == 0.0);
  for (const std::size_t k : {0U, 1U, 2U, 3U}) {
    CAPTURE(right.parameters[k].name);
    CHECK(std::abs(off(right, k)) < 3.0);
    CHECK(std::abs(off(wrong, k)) < 3.0);
  }
  CHECK(std::abs(wrong.parameters[0].value - kMass) > 20.0 * right.parameters[0].std);  // what it must not claim
  CHECK(wrong.parameters[2].std < 1.1 * right.parameters[2].std);                       // the other axis is as it was
  // It does not average out: twice as long makes it no narrower.
  const ModelEstimate later = learnt(240.0, driven, uneven).model();
  CHECK(later.parameters[0].std > 0.8 * wrong.parameters[0].std);
  CHECK(std::abs(off(later, 0)) < 3.0);
}

TEST_CASE("misfit: what is saved says it too") {
  const auto uneven = [](int axis, double told) { return axis == 0 && told > 0.0 ? 1.4 * told : told; };
  const Identifier first = learnt(60.0, driven, uneven);
  Identifier second{IdentifierSettings{}, slider()};
  second.offer(first.save_text(), 120.0);
  (void)second.step(Thrusters{.utime = utime_after(kStart, 60.5), .has_tau = true});
  (void)second.step(StateEstimate{.utime = utime_after(kStart, 60.5), .valid = true});
  REQUIRE(second.resumed());
  CHECK(second.model().residual_excess == first.model().residual_excess);
}

TEST_CASE("identifier: an axis that nothing has moved is as unknown as it was, whatever its noise teaches") {
  const auto ahead_only = [](int axis, double t) { return axis == 0 ? driven(axis, t) : 0.0; };
  const ModelEstimate model = learnt(120.0, ahead_only, [](int, double told) { return told; }).model();
  CHECK(std::abs(off(model, 0)) < 3.0);
  CHECK(model.parameters[0].std < 0.02 * kMass);
  CHECK(std::abs(model.parameters[2].value) < 0.5 * kMass);  // drawn to zero...
  for (const std::size_t k : {2U, 3U}) {
    CAPTURE(model.parameters[k].name);
    CHECK(std::abs(off(model, k)) < 1.96);  // ...and no claim
    CHECK(model.parameters[k].std > 7.0);
  }
}
