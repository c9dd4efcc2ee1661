// A craft of propellers and rudders the whole way: simulated from shaft speeds and angles, its table imported by a map
// with a unit per column, its sensors compared, its motion fitted with its vehicle file.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/consistency/consistency.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/identification/trajectories/trajectory_fit.hpp"
#include "common/model/actuators.hpp"
#include "common/model/dynamics.hpp"
#include "common/tables/import.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

const char kMap[] =
    "source: simulated\nlicence: own\n"
    "time: {column: t, unit: s}\n"
    "pose_capture:\n"
    "  position: {columns: [x, y, none], unit: m, frame: NED}\n"
    "  euler: {columns: [none, none, psi], unit: rad, world: NED, body: FRD}\n"
    "ahrs:\n  rates: {columns: [none, none, r], unit: rad/s, frame: FRD}\n"
    "dvl:\n  velocity: {columns: [u, v, none], unit: m/s, frame: FRD}\n"
    "thrusters:\n  inputs: {columns: [n_port, n_starboard, d_port, d_starboard], units: [rpm, rpm, deg, deg]}\n";

constexpr double kStep = 0.1;  // s between rows
constexpr int kRows = 1500;
constexpr double kPrinted = 1e-5;    // relative: six decimals
constexpr double kRecovered = 0.05;  // of a number, from noisy motion
constexpr double kMuchLess = 0.8;    // of the error's cost

/// Shaft speeds [rad/s] and rudder angles [rad]: both propellers and both rudders differ, ahead and astern.
std::vector<double> commands_at(double t, double phase) {
  const auto swing = [&](double period, double shift) {
    return std::sin(2.0 * std::numbers::pi * t / period + shift + phase);
  };
  const double ahead = 45.0 + 30.0 * swing(61.0, 0.3), apart = 18.0 * swing(23.0, 1.0);
  const double together = swing(17.0, 2.0) > 0.0 ? 0.3 : -0.3;
  return {ahead + apart, ahead - apart, together + 0.15 * swing(7.3, 0.0), together - 0.15 * swing(7.3, 0.5)};
}

/// The log of 150 s of the craft, with effects if any.
std::string table_of(const model::Vehicle& craft, const std::vector<model::ActiveEffect>& effects, unsigned seed) {
  model::Model truth = model::nominal_model(craft, false);
  for (const auto& effect : effects) truth.add(effect);
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  constexpr int kSubsteps = 10;
  const double h = kStep / kSubsteps;
  Vector6d nu = Vector6d::Zero();
  double x = 0.0, y = 0.0, psi = 0.2 * seed;
  std::string text = "t,x,y,psi,u,v,r,n_port,n_starboard,d_port,d_starboard\n";
  std::vector<double> sent;  // held until the next row
  const auto acceleration = [&](const Vector6d& velocity, double t) {
    const std::vector<double> force = model::forces_of_commands(craft, sent, 0.0);
    model::Motion motion{.t = t, .nu = velocity, .vehicle = &craft};
    motion.force = Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
    model::feel(truth, motion, {}, 0.0);
    return model::acceleration(truth, motion);
  };
  for (int k = 0; k < kRows; ++k) {
    const double t = kStep * k;
    const auto noisy = [&](double value, double sigma) { return "," + std::to_string(value + sigma * normal(random)); };
    sent = commands_at(t, seed);
    text += std::to_string(t) + noisy(x, 0.01) + noisy(y, 0.01) + noisy(psi, 0.001) + noisy(nu[0], 0.005) +
            noisy(nu[1], 0.005) + noisy(nu[5], 0.002);
    for (std::size_t i = 0; i < 2; ++i) text += "," + std::to_string(sent[i] * 30.0 / std::numbers::pi);  // rpm
    for (std::size_t i = 2; i < 4; ++i) text += "," + std::to_string(sent[i] * 180.0 / std::numbers::pi);
    text += "\n";
    for (int s = 0; s < kSubsteps; ++s) {
      const double now = t + s * h;
      const Vector6d middle = nu + 0.5 * h * acceleration(nu, now);
      nu += h * acceleration(middle, now + 0.5 * h);
      const double heading = psi + 0.5 * h * middle[5];
      x += h * (std::cos(heading) * middle[0] - std::sin(heading) * middle[1]);
      y += h * (std::sin(heading) * middle[0] + std::cos(heading) * middle[1]);
      psi += h * middle[5];
    }
  }
  return text;
}

/// Two such logs, imported, checked and reconstructed.
std::vector<Trial> trials_of(const model::Vehicle& craft, const std::vector<model::ActiveEffect>& effects) {
  const test::Scratch scratch;
  const std::string map_file = scratch.path("map.yaml");
  test::write_bytes(map_file, kMap);
  std::vector<Recording> recordings;
  for (unsigned run = 1; run <= 2; ++run) {
    const std::string csv = scratch.path("run" + std::to_string(run) + ".csv");
    test::write_bytes(csv, table_of(craft, effects, run));
    recordings.push_back(tables::import_csv(csv, map_file, craft.dof).recording);
    REQUIRE(static_cast<int>(recordings.back().thrusters.size()) == kRows);
  }
  // What came in is what was sent, in the units of the vehicle file.
  const std::vector<double> sent = commands_at(kStep * 7, 1);
  for (std::size_t i = 0; i < sent.size(); ++i)
    CHECK(recordings[0].thrusters[7].pwm_us[i] == doctest::Approx(sent[i]).epsilon(kPrinted));
  consistency::ConsistencyResult checked = consistency::check_consistency(recordings);
  consistency::check_thrusters(recordings, craft, checked);
  std::vector<Trial> trials;
  for (std::size_t i = 0; i < recordings.size(); ++i)
    trials.push_back(estimation::reconstruct(recordings[i], checked.corrections[i], craft));
  const std::vector<double> force = model::forces_of_commands(craft, sent, 0.0);
  for (std::size_t i = 0; i < force.size(); ++i)
    CHECK(trials[0].input[7][static_cast<Eigen::Index>(i)] == doctest::Approx(force[i]).epsilon(kPrinted));
  return trials;
}

double base_of(const identification::FitResult& fit, model::BaseParameter parameter) {
  return fit.model.theta[model::index(parameter)];
}

}  // namespace

TEST_CASE("actuators: propellers by rpm and rudders by angle go the whole way from a table to the craft's numbers") {
  const model::Vehicle craft = test::vehicle_from_repository("twin_screw_launch");
  const std::vector<Trial> trials = trials_of(craft, {});
  const identification::TrajectoryFit problem{craft, trials, {.window = 5.0, .threads = 1}};
  const identification::FitResult fit = problem.fit(model::nominal_model(craft, false));
  const model::Model truth = model::nominal_model(craft, false);
  for (const auto parameter : {model::BaseParameter::m_X, model::BaseParameter::I_Z}) {
    CAPTURE(model::name(parameter));
    CHECK(base_of(fit, parameter) == doctest::Approx(truth.theta[model::index(parameter)]).epsilon(kRecovered));
  }
}

TEST_CASE(
    "actuators: a rudder that gives half of its force is told by its number, and nothing else explains the turns") {
  constexpr int kPortRudder = 2, kPortPropeller = 0;
  const model::Vehicle craft = test::vehicle_from_repository("twin_screw_launch");
  const std::vector<Trial> trials = trials_of(craft, {test::active("thruster_gain", {-0.5}, kPortRudder)});
  const identification::TrajectoryFit problem{craft, trials, {.window = 5.0, .threads = 1}};
  const identification::FitResult without = problem.fit(model::nominal_model(craft, false));
  const auto with = [&](int thruster) {
    model::Model model = without.model;
    model.add(test::active("thruster_gain", {-0.05}, thruster));
    return problem.fit(model, &without);
  };
  const identification::FitResult rudder = with(kPortRudder), propeller = with(kPortPropeller);
  CHECK(rudder.model.effects.front().theta.front() == doctest::Approx(-0.5).epsilon(kRecovered));
  CHECK(rudder.cost < kMuchLess * without.cost);
  CHECK(rudder.cost < kMuchLess * propeller.cost);
}

}  // namespace fathom
