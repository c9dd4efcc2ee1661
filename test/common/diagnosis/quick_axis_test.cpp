// From recording to parameters where an axis settles as fast as commands change: nothing on the way may round its
// motion, for a fit would take that for a smaller inertia.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/base/spatial.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/identification/fit_from_priors.hpp"
#include "common/identification/input_hold.hpp"
#include "common/identification/sparse.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kRow = 0.01;      // s between rows of the recording
constexpr double kFine = 1e-3;     // s, of the truth's integration
constexpr double kInertia = 0.18;  // kg m^2; settles in 0.11 s at rest, in 0.03 s at 0.2 rad/s
constexpr double kLinear = -1.6, kSquare = -12.9;

enum class Commands { kHeld, kStraight };

/// Yaw alone, without noise: moments that step, swing and return.
Recording yawing(Commands commands, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Recording recording;
  recording.name = "yaw";
  double r = 0.0, psi = 0.0, step = 0.0;
  constexpr int kRows = 12000;
  std::vector<double> moment;
  for (int k = 0; k <= kRows; ++k) {
    if (k % 70 == 0) step = 0.6 * any(random);
    moment.push_back(step + 0.2 * std::sin(5.0 * kRow * k));
  }
  for (int k = 0; k < kRows; ++k) {
    const Utime utime = utime_after(0, 1.0 + kRow * k);
    recording.pose_capture.push_back({.utime = utime,
                                      .p_WB = Eigen::Vector3d::Zero(),
                                      .q_WB = quaternion_from_rotation_vector({0.0, 0.0, psi}),
                                      .valid = true});
    Ahrs ahrs;
    ahrs.utime = utime;
    ahrs.w_WB_B = {0.0, 0.0, r};
    ahrs.has_rates = true;
    recording.ahrs.push_back(ahrs);
    recording.dvl.push_back({.utime = utime, .v_WB_B = Eigen::Vector3d::Zero(), .altitude = 0.0, .valid = true});
    Thrusters thrusters;
    thrusters.utime = utime;
    thrusters.has_tau = true;
    const auto row = static_cast<std::size_t>(k);
    thrusters.tau = {0.0, 0.0, 0.0, 0.0, 0.0, moment[row]};
    recording.thrusters.push_back(thrusters);
    for (double s = 0.5 * kFine; s < kRow; s += kFine) {
      const double share = commands == Commands::kHeld ? 0.0 : s / kRow;
      const double now = (1.0 - share) * moment[row] + share * moment[row + 1];
      const auto slope = [&](double rate) {
        return (now + kLinear * rate + kSquare * std::abs(rate) * rate) / kInertia;
      };
      const double middle = r + 0.5 * kFine * slope(r);
      r += kFine * slope(middle);
      psi += kFine * middle;
    }
  }
  return recording;
}

}  // namespace

TEST_CASE("quick axis: inertia and drag come back from rows of 100 Hz, at the rates of search and of fit") {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  vehicle.dof = {false, false, false, false, false, true};
  vehicle.parameters = {"I_Z", "N_r", "N_r|r|"};
  vehicle.priors = {{.mean = 0.16, .sigma = 0.5}, {.mean = -1.4, .sigma = 5.0}, {.mean = -10.3, .sigma = 20.0}};
  constexpr double kBias = 0.003;
  constexpr double kShape = 0.01;  // means of velocities over 40 ms blur where linear drag ends and quadratic begins
  for (const Commands commands : {Commands::kHeld, Commands::kStraight}) {
    const Trial trial = estimation::reconstruct(yawing(commands, 5), {}, vehicle);
    for (const double step : {0.02, 0.04}) {
      const std::vector<Trial> trials{identification::sparse(trial, step)};
      const identification::FitSettings settings{.window = 10.0, .threads = 1, .tolerance = 1e-8};
      const identification::TrajectoryFit problem{vehicle, trials, settings};
      const identification::FitResult fit =
          identification::with_input_hold(problem, identification::fit_from_priors(vehicle, trials, settings));
      CAPTURE(step);
      CAPTURE(static_cast<int>(commands));
      CAPTURE(fit.model.input_hold);
      CHECK(fit.model.theta[model::index(model::BaseParameter::I_Z)] == doctest::Approx(kInertia).epsilon(kBias));
      CHECK(fit.model.theta[model::index(model::BaseParameter::N_r)] == doctest::Approx(kLinear).epsilon(kShape));
      CHECK(fit.model.theta[model::index(model::BaseParameter::N_rr)] == doctest::Approx(kSquare).epsilon(kShape));
    }
  }
}
