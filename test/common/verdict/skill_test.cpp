#include "common/verdict/skill.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::verdict;

namespace {

/// A vehicle of one axis, flown by an equation that a plain fit can hold: 2 kg, 3 N s/m, 1 N s^2/m^2.
Trial one_axis(double sign) {
  Trial trial;
  trial.dt = 0.02;
  trial.observed.velocity = true;
  trial.input_is_wrench = true;
  double v = 0.0;
  for (std::size_t k = 0; k < 6000; ++k) {
    const double t = static_cast<double>(k) * trial.dt;
    const double force = 4.0 * std::sin(0.9 * t) + 2.0 * std::sin(2.3 * t + 1.0);
    trial.t.push_back(t);
    trial.nu.push_back(Vector6d{v, 0.0, 0.0, 0.0, 0.0, 0.0});
    trial.input.push_back(Vector6d{sign * force, 0.0, 0.0, 0.0, 0.0, 0.0});
    trial.velocity_valid.push_back(1);
    v += trial.dt * (force - 3.0 * v - std::abs(v) * v) / 2.0;
  }
  return trial;
}

model::Vehicle surge_alone() {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  vehicle.dof = {true, false, false, false, false, false};
  return vehicle;
}

model::Vehicle pitch_alone() {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  vehicle.dof = {false, false, false, false, true, false};
  return vehicle;
}

/// A glider's pitch: 10 kg m^2, 20 N m s, righted by 4 N m; its pilot moves a weight by the pitch that he sees, slowly.
/// Measured every `every` samples.
Trial trimmed(std::size_t every) {
  Trial trial;
  trial.dt = 0.1;
  trial.observed.rates = trial.observed.attitude = true;
  trial.input_is_wrench = true;
  double q = 0.0, pitch = 0.0, moment = 0.0;
  for (std::size_t k = 0; k < 12000; ++k) {
    const double wanted = k / 1500 % 2 == 0 ? 0.45 : -0.45;
    trial.t.push_back(static_cast<double>(k) * trial.dt);
    trial.nu.push_back(Vector6d{0.0, 0.0, 0.0, 0.0, q, 0.0});
    trial.q_WB.emplace_back(Eigen::AngleAxisd{pitch, Eigen::Vector3d::UnitY()});
    trial.input.push_back(Vector6d{0.0, 0.0, 0.0, 0.0, moment, 0.0});
    trial.rates_valid.push_back(k % every == 0 ? 1 : 0);
    moment += trial.dt * 0.1 * (wanted - pitch);
    q += trial.dt * (moment - 20.0 * q - 4.0 * std::sin(pitch)) / 10.0;
    pitch += trial.dt * q;
  }
  return trial;
}

}  // namespace

TEST_CASE("skill: the plain fit finds an equation of one axis, and predicts by it") {
  const model::Vehicle vehicle = surge_alone();
  const Trial trial = one_axis(1.0);
  const std::array<PlainAxis, 6> plain = plain_fit(vehicle, {&trial, 1});
  REQUIRE(plain[0].known);
  CHECK_FALSE(plain[1].known);
  CHECK(plain[0].input == doctest::Approx(0.5).epsilon(0.03));
  CHECK(plain[0].linear == doctest::Approx(-1.5).epsilon(0.1));
  CHECK(plain[0].t_of_input > 50.0);
  const auto windows = residual::prediction_windows({&trial, 1});
  REQUIRE(windows.size() > 10);
  const auto unchanged = predict_unchanged(windows), by_axis = predict_plainly(vehicle, plain, windows);
  // As if the plain fit were the model.
  const std::vector<SkillGiven> rows = skill_of(vehicle, by_axis, unchanged, by_axis);
  REQUIRE(rows.size() == 3);
  for (const SkillGiven& row : rows) {
    CHECK(row.axis == "X");
    CHECK(row.over_unchanged > 0.95);
    CHECK(row.over_plain == 0.0);
  }
  CHECK(p_no_worse(by_axis, unchanged, 1, 0) == 1.0);
  CHECK(p_no_worse(unchanged, by_axis, 1, 0) < 1e-3);
}

TEST_CASE("skill: thrust that does not act has no t, and one that pushes the other way a negative one") {
  const model::Vehicle vehicle = surge_alone();
  Trial idle = one_axis(1.0);
  for (std::size_t k = 0; k < idle.size(); ++k) idle.input[k][0] = std::sin(37.0 * static_cast<double>(k * k % 101));
  CHECK(std::abs(plain_fit(vehicle, {&idle, 1})[0].t_of_input) < 3.0);
  const Trial reversed = one_axis(-1.0);
  CHECK(plain_fit(vehicle, {&reversed, 1})[0].t_of_input < -50.0);
}

TEST_CASE("skill: a trim that holds a tilted craft is not taken for thrust that pushes the other way") {
  const model::Vehicle vehicle = pitch_alone();
  for (const std::size_t every : {std::size_t{1}, std::size_t{40}}) {
    CAPTURE(every);
    const Trial trial = trimmed(every);
    const PlainAxis plain = plain_fit(vehicle, {&trial, 1})[4];
    REQUIRE(plain.known);
    CHECK(plain.t_of_input > 3.0);
  }
}
