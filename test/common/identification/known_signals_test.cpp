// What a log's SIGNAL tells a regression: the water's velocity as it changes, and the umbilical's length.
#include "common/identification/known_signals.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "common/base/error.hpp"
#include "common/identification/regression/manoeuvre_regression.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/sensors/kinematic_point.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::identification {
namespace {

constexpr double kExact = 1e-9;

Signal signal(const char* quantity, const char* unit, double t, double value) {
  return {.utime = utime_after(0, t), .name = "column", .quantity = quantity, .unit = unit, .value = value};
}

/// Level at 0.5 m/s ahead for 10 s; thrusters that give nothing.
Recording ahead() {
  Recording recording{.name = "run"};
  for (int k = 0; k <= 500; ++k) {
    SmoothedState state{.utime = utime_after(0, 0.02 * k)};
    state.nu[0] = 0.5;
    recording.smoothed.push_back(state);
    recording.thrusters.push_back({.utime = state.utime, .force = {0.0, 0.0}});
  }
  return recording;
}

model::Vehicle without_cells() {
  model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  vehicle.hydrodynamics->load_cells.clear();
  return vehicle;
}

}  // namespace

TEST_CASE("known signals: straight lines between values, held at the ends, and only in their unit") {
  Recording recording{.name = "run"};
  recording.signals = {signal(kPaidOut, "m", 1.0, 5.0), signal("wind_speed_true", "m/s", 1.5, 9.0),
                       signal(kPaidOut, "m", 3.0, 9.0)};
  const KnownSignal length{recording, kPaidOut, "m"};
  CHECK(length.at(utime_after(0, 0.0)) == 5.0);
  CHECK(length.at(utime_after(0, 1.5)) == doctest::Approx(6.0));
  CHECK(length.rate(utime_after(0, 1.5)) == doctest::Approx(2.0));
  CHECK(length.at(utime_after(0, 9.0)) == 9.0);
  CHECK(length.rate(utime_after(0, 9.0)) == 0.0);
  CHECK(KnownFlow{recording}.empty());
  recording.signals.front().unit = "turns";
  CHECK_THROWS_WITH_AS((KnownSignal{recording, kPaidOut, "m"}), doctest::Contains("in 'turns'; it is read in m"),
                       InputError);
}

TEST_CASE("water that moves: a body of the water's weight goes with it, speeding up and turning") {
  model::Vehicle vehicle = without_cells();
  vehicle.buoyancy = vehicle.mass * model::kGravity;
  vehicle.hydrodynamics->p_BB.setZero();
  const Eigen::Vector3d a{0.02, -0.01, 0.005}, v{0.3, 0.1, -0.05}, w{0.01, -0.02, 0.1};
  const Vector6d M = model::total_inertia(vehicle).diagonal();
  const Vector6d level = model::rigid_wrench(vehicle, Eigen::Vector3d::UnitZ(), Vector6d::Zero());
  CHECK(level.norm() < kExact);
  // Carried along by water that speeds up.
  const Vector6d carried = model::water_wrench(vehicle, Eigen::Vector3d::Zero(), v, a);
  CHECK((carried.head<3>() - M.head<3>().cwiseProduct(a)).norm() < kExact);
  CHECK(carried.tail<3>().norm() < kExact);
  // Carried along by steady water while it turns: in B, v turns the other way.
  Vector6d nu;
  nu << v, w;
  Vector6d nu_dot = Vector6d::Zero();
  nu_dot.head<3>() = -w.cross(v);
  const Vector6d wrench = model::rigid_wrench(vehicle, Eigen::Vector3d::UnitZ(), nu) +
                          model::water_wrench(vehicle, w, v, Eigen::Vector3d::Zero());
  CHECK((wrench.head<3>() - M.head<3>().cwiseProduct(nu_dot.head<3>())).norm() < kExact);
}

TEST_CASE("regress: an umbilical whose length the log tells pulls with its length") {
  const model::Vehicle vehicle = without_cells();
  Recording recording = ahead();
  const ManoeuvreRows without = rows_of(recording, vehicle, 10.0);
  CHECK(without.known_from == "THRUSTERS");
  CHECK(without.stretches.front().front().known.norm() < kExact);
  recording.signals = {signal(kPaidOut, "m", 0.0, 5.0), signal(kPaidOut, "m", 10.0, 15.0)};
  const ManoeuvreRows rows = rows_of(recording, vehicle, 10.0);
  CHECK(rows.known_from == "THRUSTERS, the umbilical's length");
  const auto& stretch = rows.stretches.front();
  // 1/2 rho C_d d L / 3 v^2 = 1/2 1025 1.2 0.006 10 / 3 0.25 = 3.075 N where 10 m are out.
  CHECK(stretch[stretch.size() / 2].known[0] == doctest::Approx(-3.075).epsilon(0.02));
  CHECK(stretch.front().known[0] == doctest::Approx(-1.5375).epsilon(0.05));
  CHECK(stretch.back().pulls[0][0] == doctest::Approx(-4.6125).epsilon(0.05));
  // Where a cell measures it, the cell is believed.
  const model::Vehicle with_cells = test::vehicle_from_repository("pap104_half");
  for (const SmoothedState& one : recording.smoothed)
    recording.loads.push_back({.utime = one.utime, .load = std::vector<double>(8, 0.0)});
  CHECK(rows_of(recording, with_cells, 10.0).known_from == "load cells");
}

TEST_CASE("regress: the water's velocity that a log tells is taken off, and what its acceleration pushes") {
  const model::Vehicle vehicle = without_cells();
  Recording recording = ahead();
  const AxisCandidates surge = candidates_of(0, model::gertler_submarine());
  const auto x_uu = std::ranges::find(surge.names, "X_uu") - surge.names.begin();
  const auto of = [&](const Recording& log, const Eigen::Vector3d& v_WF) {
    const ManoeuvreRows rows = rows_of(log, vehicle, 10.0);
    return columns_of(rows.stretches.front(), 0, surge, vehicle, v_WF);
  };
  const Eigen::MatrixXd still = of(recording, Eigen::Vector3d::Zero());
  // Steady: as if it had been given by hand.
  recording.signals = {signal(kWaterVelocity[0], "m/s", 0.0, 0.2)};
  CHECK((of(recording, Eigen::Vector3d::Zero()) - of(ahead(), {0.2, 0.0, 0.0})).norm() < kExact);
  // From 0 to 0.2 m/s in 10 s: the hull sees 0.4 m/s in the middle, and 0.02 m/s^2 push on displaced and added mass.
  recording.signals = {signal(kWaterVelocity[0], "m/s", 0.0, 0.0), signal(kWaterVelocity[0], "m/s", 10.0, 0.2)};
  const Eigen::MatrixXd rising = of(recording, Eigen::Vector3d::Zero());
  const Eigen::Index middle = rising.rows() / 2, b = rising.cols() - 1;
  CHECK(rising(middle, x_uu) / still(middle, x_uu) == doctest::Approx(0.64).epsilon(0.02));
  CHECK(rising(middle, b) - still(middle, b) == doctest::Approx(-0.02 * (866.0 / 9.80665 + 6.0)).epsilon(1e-6));
}

}  // namespace fathom::identification
