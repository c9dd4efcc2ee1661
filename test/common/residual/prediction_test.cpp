// Prediction errors: by hand on constant offsets, and on a simulated dive whose truth is known.
#include "common/residual/prediction.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/estimation/split.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::residual;

TEST_CASE("prediction: windows of 10 s every 5 s, each beginning at a valid sample") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 30.0});
  auto windows = prediction_windows({&dive.trial, 1});
  REQUIRE(windows.size() == 5);
  CHECK(windows[0].start == 0);
  CHECK(windows[1].start == 50);
  CHECK(windows[4].start == 200);
  CHECK(windows[0].count == 101);
  dive.trial.velocity_valid[50] = 0;
  windows = prediction_windows({&dive.trial, 1});
  CHECK(windows[1].start == 51);
}

TEST_CASE("prediction: a vehicle without forces and drag keeps its speed, so the error is the measurement's change") {
  model::Vehicle vehicle;
  vehicle.dof = {true, false, false, false, false, false};
  vehicle.mass = 1.0;
  model::Model model = model::nominal_model(vehicle, true);
  model.theta.head<6>().setOnes();
  Trial trial;
  trial.dt = 0.1;
  trial.input_is_wrench = true;
  trial.observed = {true, true, true, true};
  for (std::size_t k = 0; k <= 100; ++k) {
    trial.t.push_back(0.1 * static_cast<double>(k));
    trial.p_WB.emplace_back(0, 0, 0);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Unit(0) * 0.1 * trial.t.back());  // 0.1 m/s^2 that the model does not know
    trial.input.emplace_back(Eigen::VectorXd::Zero(6));
  }
  trial.pose_valid.assign(101, 1);
  trial.velocity_valid.assign(101, 1);
  trial.rates_valid.assign(101, 1);
  const auto windows = prediction_windows({&trial, 1});
  REQUIRE(windows.size() == 1);
  const auto rows = predict(model, windows).summary(vehicle);
  // RMS of 0.01 k, k = 1..n: 0.01 sqrt((n+1)(2n+1)/6).
  const std::array<double, 3> samples{10, 50, 100};
  for (std::size_t h = 0; h < 3; ++h) {
    const double n = samples[h];
    CHECK(rows[h].rmse[0] == doctest::Approx(0.01 * std::sqrt((n + 1) * (2 * n + 1) / 6)));
    // Variance of k = 1..n is (n^2 - 1)/12.
    CHECK(rows[h].r2[0] == doctest::Approx(1.0 - (n + 1) * (2 * n + 1) / 6 / ((n * n - 1) / 12)));
    CHECK(std::isnan(rows[h].rmse[1]));  // left out
  }
}

TEST_CASE("prediction: the truth beats a model without the hidden lag, and says so with certainty") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 200.0, .seed = 2, .effects = {test::active("thruster_lag", {0.5})}});
  model::Model ignorant = dive.truth;
  ignorant.effects.clear();
  const auto windows = prediction_windows({&dive.trial, 1});
  const Predictions before = predict(ignorant, windows);
  const Predictions after = predict(dive.truth, windows);
  const Interval gain = improvement(before, after, vehicle);
  CHECK(gain.low > 0.2);
  CHECK(gain.low <= gain.value);
  CHECK(gain.value <= gain.high);
  const Interval none = improvement(before, before, vehicle);
  CHECK(none.value == 0.0);
  CHECK(none.high - none.low < 1e-12);
  CHECK(after.summary(vehicle)[0].r2[0] > 0.95);
}

TEST_CASE("prediction: no prediction starts from a velocity that was guessed across a gap") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 45.0});
  Trial& trial = dive.trial;
  REQUIRE(trial.size() == 451);
  CHECK(restarts(trial) == std::vector<std::size_t>{0, 100, 200, 300, 400});
  // A gap where the second prediction would begin: what stands in nu there must not be used.
  for (std::size_t k = 95; k < 120; ++k) {
    trial.velocity_valid[k] = 0;
    trial.nu[k].setConstant(100.0);
  }
  trial.rates_valid[120] = 0;
  trial.pose_valid[121] = 0;
  const std::vector<std::size_t> starts = restarts(trial);
  CHECK(starts == std::vector<std::size_t>{0, 122, 222, 322, 422});
  const auto predicted = predict_anew(dive.truth, trial, starts);
  REQUIRE(predicted.size() == trial.size());
  for (const std::size_t start : starts) CHECK(predicted[start][0] == trial.nu[start][0]);
  CHECK(std::isfinite(predicted[99][0]));
  for (std::size_t k = 100; k < 122; ++k) CHECK(std::isnan(predicted[k][0]));  // 10 s are over, nothing to start from
  for (std::size_t k = 0; k < trial.size(); ++k) {
    if (k < 100 || k >= 122) CHECK(std::abs(predicted[k][0]) < 5.0);  // m/s
    CHECK(std::isnan(predicted[k][4]));                               // pitch is not simulated
  }
  // A signal that was never observed holds up nothing; one that never becomes valid leaves no prediction.
  trial.observed.attitude = false;
  CHECK(restarts(trial)[1] == 121);
  trial.rates_valid.assign(trial.size(), 0);
  CHECK(restarts(trial).empty());
  CHECK(std::isnan(predict_anew(dive.truth, trial, {})[0][0]));
}

TEST_CASE("prediction: what was cut out of a longer run is predicted from where a model with a memory can know it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 160.0,
                                .seed = 5,
                                .effects = {test::active("fluid_memory", {30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0}, 0)}});
  const Trial cut = estimation::split(dive.trial, 0.7).second;
  CHECK(lead_of(dive.truth) == doctest::Approx(24.0));
  const auto all = prediction_windows({&cut, 1}), late = prediction_windows({&cut, 1}, lead_of(dive.truth));
  CHECK(late.front().start == 240);
  const auto error = [&](std::span<const model::Window> windows) {
    return predict(dive.truth, windows).summary(vehicle)[0].rmse[0];
  };
  CHECK(error(late) < 0.01);  // 5 mm/s each in the start, in what is remembered, and in the measurement
  CHECK(error({all.data(), 1}) > 2.0 * error(late));  // at the cut nobody knows what the water remembers
  CHECK(prediction_windows({&cut, 1}, 1e3).size() == all.size());
  model::Model plain = dive.truth;
  plain.effects.clear();
  CHECK(lead_of(plain) == 0.0);
}

TEST_CASE("prediction: what is certain of the share foretold grows with the windows, by Student's t") {
  Predictions made;
  made.variance[1][0] = 1.0;
  const auto window = [](double mean_square) {
    WindowErrors errors;
    errors.square[1][0] = 50.0 * mean_square;
    errors.count[1][0] = 50.0;
    return errors;
  };
  made.windows = {window(3.0)};
  CHECK(made.p_foretells(0.0, 1, 0) == 1.0);  // one window has no scatter
  made.windows = {window(3.0), window(1.0)};
  // 2 and 0 beyond the average's: t = 1 with one degree of freedom, a quarter lies above.
  CHECK(made.p_foretells(0.0, 1, 0) == doctest::Approx(0.25));
  made.windows = {window(3.0), window(1.0), window(3.0), window(1.0), window(3.0), window(1.0)};
  CHECK(made.p_foretells(0.0, 1, 0) == doctest::Approx(0.0379).epsilon(0.01));  // t = sqrt(5), five degrees of freedom
  CHECK(made.p_foretells(0.5, 1, 0) < made.p_foretells(0.0, 1, 0));
  made.noise[0] = 1.0;  // there was no motion at all: twice the noise is what no model can help
  CHECK(made.p_foretells(0.5, 1, 0) == 1.0);
  CHECK(made.p_foretells(0.5, 1, 3) == 1.0);  // an axis without samples
}

TEST_CASE("prediction: the truth is never caught foretelling less than half, in motion or at rest") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  constexpr unsigned kSeeds = 20;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    CAPTURE(seed);
    test::VirtualDive dive = test::make_dive(vehicle, {.duration = 60.0, .seed = seed});
    const auto moved = predict(dive.truth, prediction_windows({&dive.trial, 1})).summary(vehicle);
    // At rest: noise is all that is measured.
    model::Model still = dive.truth;
    still.theta.tail<4>().setZero();
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    for (std::size_t k = 0; k < dive.trial.size(); ++k) {
      for (int axis = 0; axis < 6; ++axis) dive.trial.nu[k][axis] = dive.trial.nu_sigma[axis] * normal(random);
      dive.trial.input[k].setZero();
    }
    const auto rest = predict(still, prediction_windows({&dive.trial, 1})).summary(vehicle);
    for (const std::size_t axis : {0UL, 1UL, 2UL, 5UL}) {
      CHECK(moved[1].p_half[axis] > 0.01);
      CHECK(rest[1].p_half[axis] > 1e-3);
      CHECK(rest[1].p_average[axis] > 1e-3);
    }
  }
}
