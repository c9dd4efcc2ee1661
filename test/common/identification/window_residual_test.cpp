// Windows keep clear of gaps, residual rows of invalid samples, and the derivatives are those of the residual.
#include "common/identification/trajectories/window_residual.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kLength = 5.0;  // s

struct Fixture {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 60.0, .seed = 51});

  void invalidate(double from, double until) {
    for (std::size_t k = 0; k < dive.trial.size(); ++k) {
      if (dive.trial.t[k] < from || dive.trial.t[k] >= until) continue;
      dive.trial.velocity_valid[k] = 0;
      dive.trial.nu[k].head<3>().setConstant(1e3);  // must never be seen
    }
  }
  [[nodiscard]] std::vector<model::Window> cut() const { return cut_windows({&dive.trial, 1}, kLength); }
};

}  // namespace

TEST_CASE("windows: of a whole run, they share their ends and cover it") {
  const Fixture fixture;
  const auto windows = fixture.cut();
  REQUIRE(windows.size() == 12);
  for (std::size_t w = 0; w < windows.size(); ++w) {
    CHECK(windows[w].trial == &fixture.dive.trial);
    CHECK(windows[w].start == 50 * w);
    CHECK(windows[w].count == 51);
  }
}

TEST_CASE("windows: they begin where everything is valid and keep at least half of their samples") {
  Fixture fixture;
  fixture.invalidate(12.0, 13.0);  // short: bridged
  fixture.invalidate(25.0, 33.0);  // longer than a window
  fixture.invalidate(40.0, 40.1);  // one sample, where a window would begin
  const auto windows = fixture.cut();
  const Trial& trial = fixture.dive.trial;
  REQUIRE(windows.size() >= 8);
  bool bridged = false;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    CHECK(trial.velocity_valid[windows[w].start] != 0);
    CHECK(windows[w].start + windows[w].count <= trial.size());
    if (w > 0) CHECK(windows[w].start + 1 >= windows[w - 1].start + windows[w - 1].count);
    const auto begin = trial.velocity_valid.begin() + static_cast<std::ptrdiff_t>(windows[w].start);
    const auto valid = std::count(begin, begin + static_cast<std::ptrdiff_t>(windows[w].count), 1);
    CHECK(2 * valid >= static_cast<std::ptrdiff_t>(windows[w].count));
    const double from = trial.t[windows[w].start];
    bridged = bridged || (from < 12.0 && from + kLength > 13.0);
    CHECK_FALSE((from >= 25.0 && from < 33.0));
  }
  CHECK(bridged);
}

TEST_CASE("windows: none in a run that is too short or never valid") {
  Fixture fixture;
  CHECK(cut_windows({&fixture.dive.trial, 1}, 61.0).empty());
  fixture.invalidate(0.0, 100.0);
  CHECK(fixture.cut().empty());
}

TEST_CASE("windows: samples further apart than a window end too") {
  Fixture fixture;
  fixture.dive.trial.dt = 8.0 * kLength;
  CHECK(cut_windows({&fixture.dive.trial, 1}, kLength).front().count == 2);
}

TEST_CASE("residual: rows are the valid samples of observed, simulated axes") {
  Fixture fixture;
  fixture.invalidate(2.0, 3.0);
  const WindowResidual residual{{&fixture.dive.trial, 0, 51}, fixture.vehicle};
  CHECK(residual.rows() == 3 * 41 + 51);  // u v w with ten samples missing, r with none
  int yaw = 0;
  for (Eigen::Index i = 0; i < residual.rows(); ++i) {
    CHECK(residual.axis(i) != 3);
    CHECK(residual.axis(i) != 4);
    yaw += residual.axis(i) == 5 ? 1 : 0;
  }
  CHECK(yaw == 51);
  fixture.dive.trial.observed.velocity = false;
  CHECK(WindowResidual{{&fixture.dive.trial, 0, 51}, fixture.vehicle}.rows() == 51);
}

TEST_CASE("residual: the truth leaves the noise that was put in, in units of sigma, and never sees invalid samples") {
  Fixture fixture;
  fixture.invalidate(2.0, 3.0);
  const WindowResidual residual{{&fixture.dive.trial, 0, 51}, fixture.vehicle};
  Eigen::VectorXd r(residual.rows());
  model::VelocityTrace trace;
  REQUIRE(residual.evaluate(fixture.dive.truth, Vector6d::Zero(), fixture.dive.trial.nu_sigma, trace, r));
  // 174 normal numbers plus the rollout's steps of 50 ms: their rms is 1 within four standard deviations of 0.05.
  const double rms = r.norm() / std::sqrt(static_cast<double>(r.size()));
  CHECK(rms > 0.8);
  CHECK(rms < 1.3);
  Eigen::VectorXd doubled(residual.rows());
  residual.evaluate(fixture.dive.truth, Vector6d::Zero(), 2.0 * fixture.dive.trial.nu_sigma, trace, doubled);
  CHECK((2.0 * doubled - r).norm() < 1e-12 * r.norm());
}

TEST_CASE("residual: derivatives by effects' numbers and initial velocity agree with central differences") {
  Fixture fixture;
  // Ballast: yaw that settles in 15 ms has derivatives that live within one step (see sensitivity_test.cpp).
  fixture.dive.truth.theta[model::index(model::BaseParameter::I_Z)] = 2.0;
  model::Model model = fixture.dive.truth;
  model.add(test::active("thruster_lag", {0.2}));
  model.add(test::active("current", {0.08, -0.05}));
  const WindowResidual residual{{&fixture.dive.trial, 100, 51}, fixture.vehicle};
  const ParameterMap map{model};
  const Vector6d nu0 = fixture.dive.trial.nu[100];
  const Vector6d sigma = fixture.dive.trial.nu_sigma;
  model::VelocityTrace trace;
  Eigen::VectorXd at(residual.rows()), plus(residual.rows()), minus(residual.rows());
  residual.evaluate(model, nu0, sigma, trace, at);
  Eigen::MatrixXd by_parameter, by_initial;
  residual.jacobians(model, map, nu0, sigma, at, by_parameter, by_initial);
  constexpr double kAgreement = 0.01;  // of a column
  constexpr double kStep = 1e-3;
  const Eigen::VectorXd x = map.pack(model);
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    if (!map[static_cast<std::size_t>(j)].sought) {
      CHECK(by_parameter.col(j).isZero(0.0));
      continue;
    }
    model::Model moved = model;
    map.unpack(x + kStep * Eigen::VectorXd::Unit(x.size(), j), moved);
    residual.evaluate(moved, nu0, sigma, trace, plus);
    map.unpack(x - kStep * Eigen::VectorXd::Unit(x.size(), j), moved);
    residual.evaluate(moved, nu0, sigma, trace, minus);
    const Eigen::VectorXd central = (plus - minus) / (2.0 * kStep);
    CAPTURE(map[static_cast<std::size_t>(j)].name);
    CHECK((by_parameter.col(j) - central).norm() <= kAgreement * central.norm());
  }
  for (int axis = 0; axis < 6; ++axis) {
    CAPTURE(axis);
    if (!fixture.vehicle.dof[static_cast<std::size_t>(axis)]) {
      CHECK(by_initial.col(axis).isZero(0.0));
      continue;
    }
    residual.evaluate(model, nu0 + kStep * Vector6d::Unit(axis), sigma, trace, plus);
    residual.evaluate(model, nu0 - kStep * Vector6d::Unit(axis), sigma, trace, minus);
    const Eigen::VectorXd central = (plus - minus) / (2.0 * kStep);
    CHECK((by_initial.col(axis) - central).norm() <= kAgreement * central.norm());
  }
}
