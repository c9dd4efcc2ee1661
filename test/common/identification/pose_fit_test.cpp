// Poses make numbers better and their intervals stay true; poses that wander or are scaled do no harm, and numbers that
// contradict those by velocities are refused.
#include "common/identification/pose_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/base/spatial.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr PoseFitSettings kPoses{.window = 10.0, .block = 10.0, .threads = 1};

enum class Places { kWhite, kWandering, kScaled };

/// Noise of instruments on a dive's poses, which come without.
void add_noise(Trial& trial, Places places, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  Eigen::Vector3d walk = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < trial.size(); ++k) {
    const Eigen::Vector3d white{normal(random), normal(random), normal(random)};
    const Eigen::Vector3d turn{0.0, 0.0, 0.002 * normal(random)};
    walk += 0.003 * white;  // m, every 20 ms: 20 mm in a second
    if (places == Places::kScaled) trial.p_WB[k] *= 1.05;
    trial.p_WB[k] += places == Places::kWandering ? walk : Eigen::Vector3d{0.003 * white};
    trial.q_WB[k] = quaternion_from_rotation_vector(turn) * trial.q_WB[k];
  }
}

struct Errors {
  double speeds{}, poses{};  ///< mean squares, in standard deviations of the fit to velocities
  double held{}, count{};    ///< intervals
  int fits{}, refused{};
};

Errors over_seeds(const char* name, const PoseFitSettings& settings, Places places, unsigned seeds,
                  double upright = 1.0) {
  model::Vehicle vehicle = test::vehicle_from_repository(name);
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    if (vehicle.parameters[i] == "G_z") vehicle.priors[i].mean *= upright;
  }
  Errors errors;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    test::VirtualDive dive =
        test::make_dive(vehicle, {.duration = 180.0, .dt = 0.02, .step = 0.002, .seed = seed, .spread = 0.05});
    add_noise(dive.trial, places, seed);
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 10.0, .threads = 1}};
    FitResult by_speeds = problem.fit(dive.truth);
    problem.add_covariance(by_speeds);
    const auto fit = fit_with_poses(vehicle, {&dive.trial, 1}, settings, by_speeds);
    ++(fit ? errors.fits : errors.refused);
    if (!fit) continue;
    const auto before = by_speeds.parameters(), after = fit->parameters();
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double truth = dive.truth.theta[model::index(*model::parameter_from_name(before[i].name))];
      errors.speeds += std::pow((before[i].value - truth) / before[i].std, 2);
      errors.poses += std::pow((after[i].value - truth) / before[i].std, 2);
      errors.held += (*after[i].interval95)[0] <= truth && truth <= (*after[i].interval95)[1] ? 1.0 : 0.0;
      errors.count += 1.0;
    }
  }
  MESSAGE(name << ": rms " << std::sqrt(errors.speeds / errors.count) << " -> "
               << std::sqrt(errors.poses / errors.count) << ", intervals " << errors.held << " of " << errors.count
               << ", refused " << errors.refused);
  return errors;
}

}  // namespace

TEST_CASE("pose fit: four axes, places of 3 mm: smaller errors, true intervals") {
  const Errors errors = over_seeds("seabotix_lbv150", kPoses, Places::kWhite, 6);
  CHECK(errors.refused == 0);
  CHECK(errors.poses < 0.5 * errors.speeds);
  CHECK(errors.held >= 0.88 * errors.count);  // 78 numbers, correlated within a dive: 95 % less three deviations
}

TEST_CASE("pose fit: six axes over thirty seconds: smaller errors, true intervals") {
  const Errors errors = over_seeds("beluga", {.window = 30.0, .block = 10.0, .threads = 1}, Places::kWhite, 3);
  CHECK(errors.refused == 0);
  CHECK(errors.poses < 0.6 * errors.speeds);
  CHECK(errors.held >= 0.85 * errors.count);  // of 66
}

TEST_CASE("pose fit: places that wander by centimetres weigh little and do no harm") {
  const Errors errors = over_seeds("seabotix_lbv150", kPoses, Places::kWandering, 4);
  CHECK(errors.poses < 1.1 * errors.speeds);
  CHECK(errors.held >= 0.85 * errors.count);
}

TEST_CASE("pose fit: places whose metre is not that of the velocities do no harm") {
  const Errors errors = over_seeds("seabotix_lbv150", kPoses, Places::kScaled, 3);
  CHECK(errors.poses < 1.1 * errors.speeds);
  CHECK(errors.held >= 0.85 * errors.count);
}

TEST_CASE("pose fit: velocities whose numbers lie far from those of the poses keep their own") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 180.0, .dt = 0.02, .seed = 4});
  add_noise(dive.trial, Places::kWhite, 4);
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 10.0, .threads = 1}};
  FitResult by_speeds = problem.fit(dive.truth);
  problem.add_covariance(by_speeds);
  CHECK(fit_with_poses(vehicle, {&dive.trial, 1}, kPoses, by_speeds));
  const auto mass = model::index(model::BaseParameter::m_X);
  by_speeds.model.theta[mass] += 20.0 * std::sqrt(by_speeds.covariance(0, 0));
  CHECK_FALSE(fit_with_poses(vehicle, {&dive.trial, 1}, kPoses, by_speeds));
}

TEST_CASE("pose fit: nothing where no pose is known") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 60.0, .dt = 0.1, .seed = 2});
  dive.trial.observed.attitude = false;
  const TrajectoryFit problem{vehicle, {&dive.trial, 1}, {.window = 10.0, .threads = 1}};
  FitResult by_speeds = problem.fit(dive.truth);
  problem.add_covariance(by_speeds);
  CHECK_FALSE(fit_with_poses(vehicle, {&dive.trial, 1}, kPoses, by_speeds));
}

TEST_CASE("pose fit: a craft that tips over, whose trajectories run away from each other, is not known too well") {
  const Errors errors = over_seeds("bluerov2", {.window = 30.0, .block = 10.0, .threads = 1}, Places::kWhite, 4, -1.0);
  CHECK(errors.held >= 0.88 * errors.count);
}
