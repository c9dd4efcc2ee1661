// A glider the whole way: driven by a buoyancy engine and a battery that slides, its table imported with volumes and
// ways as it logs them, its motion fitted with its vehicle file.
#include <doctest/doctest.h>

#include <algorithm>
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
    "  position: {columns: [x, none, z], unit: m, frame: NED}\n"
    "  euler: {columns: [none, theta, none], unit: rad, world: NED, body: FRD}\n"
    "ahrs:\n  rates: {columns: [none, q, none], unit: rad/s, frame: FRD}\n"
    "dvl:\n  velocity: {columns: [u, none, w], unit: m/s, frame: FRD}\n"
    "thrusters:\n  inputs: {columns: [ballast, battpos], units: [cc, in]}\n";

constexpr double kStep = 0.2;  // s between rows
constexpr int kRows = 2400;
constexpr double kPrinted = 1e-4;    // relative: six decimals of an inch
constexpr double kRecovered = 0.06;  // of a number, from noisy motion
constexpr double kMuchLess = 0.8;    // of the error's cost

/// Volume [m^3] and way [m]: dives and climbs of 80 s, and a battery that is moved about by itself, so that what the
/// engine does to the trim is told from what the battery does.
std::vector<double> commands_at(double t, double phase) {
  const double turn = std::sin(2.0 * std::numbers::pi * t / 160.0 + phase);
  const double volume = 230e-6 * std::clamp(3.0 * turn, -1.0, 1.0);
  return {volume, 0.012 * std::sin(2.0 * std::numbers::pi * t / 47.0 + phase) + 0.008 * std::sin(0.27 * t + phase)};
}

std::string table_of(const model::Vehicle& craft, const std::vector<model::ActiveEffect>& effects, unsigned seed) {
  model::Model truth = model::nominal_model(craft, false);
  for (const auto& effect : effects) truth.add(effect);
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  constexpr int kSubsteps = 10;
  const double h = kStep / kSubsteps;
  Vector6d nu = Vector6d::Zero();
  double x = 0.0, z = 40.0, theta = 0.0;
  std::string text = "t,x,z,theta,q,u,w,ballast,battpos\n";
  const auto acceleration = [&](const Vector6d& velocity, double pitch, double t) {
    const std::vector<double> force = model::forces_of_commands(craft, commands_at(t, seed), 0.0);
    model::Motion motion{.t = t, .nu = velocity, .vehicle = &craft};
    motion.R_WB = Eigen::AngleAxisd{pitch, Eigen::Vector3d::UnitY()}.toRotationMatrix();
    motion.force = Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
    model::feel(truth, motion, {}, 0.0);
    return model::acceleration(truth, motion);
  };
  for (int k = 0; k < kRows; ++k) {
    const double t = kStep * k;
    const auto noisy = [&](double value, double sigma) { return "," + std::to_string(value + sigma * normal(random)); };
    const std::vector<double> sent = commands_at(t, seed);
    text += std::to_string(t) + noisy(x, 0.01) + noisy(z, 0.01) + noisy(theta, 0.001) + noisy(nu[4], 0.001) +
            noisy(nu[0], 0.003) + noisy(nu[2], 0.003) + "," + std::to_string(1e6 * sent[0]) + "," +
            std::to_string(sent[1] / 0.0254) + "\n";
    for (int s = 0; s < kSubsteps; ++s) {
      const double now = t + s * h;
      const Vector6d middle = nu + 0.5 * h * acceleration(nu, theta, now);
      const double pitch = theta + 0.5 * h * nu[4];
      nu += h * acceleration(middle, pitch, now + 0.5 * h);
      x += h * (std::cos(pitch) * middle[0] + std::sin(pitch) * middle[2]);
      z += h * (-std::sin(pitch) * middle[0] + std::cos(pitch) * middle[2]);
      theta += h * middle[4];
    }
  }
  return text;
}

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
  return trials;
}

double base_of(const identification::FitResult& fit, model::BaseParameter parameter) {
  return fit.model.theta[model::index(parameter)];
}

}  // namespace

TEST_CASE("glider: volumes and ways of its battery go from a table to its numbers") {
  const model::Vehicle craft = test::vehicle_from_repository("slocum");
  REQUIRE(craft.weight_moves);
  const std::vector<Trial> trials = trials_of(craft, {});
  const identification::TrajectoryFit problem{craft, trials, {.window = 10.0, .threads = 1}};
  const identification::FitResult fit = problem.fit(model::nominal_model(craft, false));
  const model::Model truth = model::nominal_model(craft, false);
  for (const auto parameter : {model::BaseParameter::m_X, model::BaseParameter::m_Z, model::BaseParameter::G_z}) {
    CAPTURE(model::name(parameter));
    CHECK(base_of(fit, parameter) == doctest::Approx(truth.theta[model::index(parameter)]).epsilon(kRecovered));
  }
}

TEST_CASE("glider: an engine that displaces a third less than it says is told by its gain, not by the battery's") {
  constexpr int kEngine = 0, kBattery = 1;
  const model::Vehicle craft = test::vehicle_from_repository("slocum");
  const std::vector<Trial> trials = trials_of(craft, {test::active("thruster_gain", {-0.35}, kEngine)});
  const identification::TrajectoryFit problem{craft, trials, {.window = 10.0, .threads = 1}};
  const identification::FitResult without = problem.fit(model::nominal_model(craft, false));
  const auto with = [&](int actuator) {
    model::Model model = without.model;
    model.add(test::active("thruster_gain", {-0.2}, actuator));
    return problem.fit(model, &without);
  };
  const identification::FitResult engine = with(kEngine), battery = with(kBattery);
  CHECK(engine.model.effects.front().theta.front() == doctest::Approx(-0.35).epsilon(0.15));
  CHECK(engine.cost < kMuchLess * without.cost);
  CHECK(engine.cost < battery.cost);
}

}  // namespace fathom
