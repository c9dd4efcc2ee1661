// docs/conventions.md, executed: a check for every line of "Signs" and of the table of the two papers. A line that is
// added there without a check here fails, and so does a check whose line has gone.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "common/model/derivative_motion.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/model/sensors/accelerometer.hpp"
#include "common/model/sensors/heading.hpp"
#include "common/model/sensors/pressure.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

using Checks = std::map<std::string, std::function<void()>>;

Vehicle free_body() {
  Vehicle vehicle;
  vehicle.name = "free";
  vehicle.dof.fill(true);
  vehicle.mass = 10.0;
  return vehicle;
}
Model body(const Vehicle& vehicle) {
  Model model = nominal_model(vehicle, true);
  model.theta.head<6>() << 12, 18, 22, 0.4, 0.7, 0.9;
  return model;
}
Motion rest(const Model& model, const Eigen::Vector3d& euler = Eigen::Vector3d::Zero()) {
  Motion motion;
  motion.R_WB = rotation_from_euler(euler);
  motion.force = ActuatorForces::Zero(model.allocation.cols());
  motion.vehicle = model.vehicle;
  return motion;
}
Vector6d pushed_by(BaseParameter parameter, double value, const Vector6d& nu = Vector6d::Zero()) {
  const Vehicle vehicle = free_body();
  Model model = body(vehicle);
  model.theta[index(parameter)] = value;
  Motion motion = rest(model);
  motion.nu = nu;
  return acceleration(model, motion);
}
const Vehicle& pap() {
  static const Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  return vehicle;
}
/// What an accelerometer along each axis shows at a kinematic state.
Eigen::Vector3d specific_force(const KinematicVector& x) {
  Eigen::Vector3d f;
  for (int i = 0; i < 3; ++i) {
    f[i] = -observe(KinematicPoint{x}, Accelerometer{.direction_B = Eigen::Vector3d::Unit(i)}, 0.0, 1.0).innovation;
  }
  return f;
}

/// Of a level circle to port: 0.5 m/s, 5 m.
KinematicVector circle_to_port() {
  KinematicVector x = KinematicVector::Zero();
  x[at::kVelocity] = 0.5;
  x[at::kRates + 2] = -0.1;
  x.segment<3>(at::kAcceleration) = Eigen::Vector3d(0.0, 0.0, -0.1).cross(Eigen::Vector3d(0.5, 0.0, 0.0));
  return x;
}

/// First cells of a table's rows, or the bullets' first words up to a comma, colon, full stop or code; of one section.
std::set<std::string> lines_of(const std::string& section) {
  std::istringstream file{test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/docs/conventions.md")};
  std::set<std::string> lines;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("## ")) inside = line == "## " + section;
    if (!inside || line.starts_with("|--")) continue;
    if (line.starts_with("- ")) lines.insert(line.substr(2, line.find_first_of(",:.", 2) - 2));
    if (line.starts_with("| ") && !line.starts_with("| here")) lines.insert(line.substr(2, line.find(" |", 2) - 2));
  }
  return lines;
}

void run(const std::string& section, const Checks& checks) {
  std::set<std::string> names;
  for (const auto& [name, check] : checks) {
    CAPTURE(name);
    names.insert(name);
    check();
  }
  for (const std::string& line : lines_of(section)) CHECK_MESSAGE(names.contains(line), "no check of: " << line);
  for (const std::string& name : names) CHECK_MESSAGE(lines_of(section).contains(name), "no such line: " << name);
}

void check_angles() {
  CHECK((rotation_from_euler({0, 0, 0.1}) * Eigen::Vector3d::UnitX()).y() > 0.0);  // clockwise seen from above
  CHECK((rotation_from_euler({0.1, 0, 0}) * Eigen::Vector3d::UnitY()).z() > 0.0);  // starboard goes down
  CHECK((rotation_from_euler({0, 0.1, 0}) * Eigen::Vector3d::UnitX()).z() < 0.0);  // the bow goes up
  KinematicVector deep = KinematicVector::Zero();
  deep[at::kPosition + 2] = 3.0;
  CHECK(observe_depth(KinematicPoint{deep}, Eigen::Vector3d::Zero(), 3.0, 1.0).innovation == doctest::Approx(0.0));
}
void check_drag() {
  const Vector6d ahead = Vector6d::Unit(0);
  CHECK(pushed_by(BaseParameter::X_u, -6.0, ahead)[0] == doctest::Approx(-0.5));
  CHECK(pushed_by(BaseParameter::X_uu, -6.0, -ahead)[0] == doctest::Approx(0.5));
}
void check_masses() {
  const Vector6d total = total_inertia(pap()).diagonal();
  CHECK(total[0] == doctest::Approx(pap().mass + pap().hydrodynamics->added_mass(0, 0)));
  CHECK(pap().hydrodynamics->added_mass.diagonal().minCoeff() > 0.0);
  CHECK(nearest_base(pap())[index(BaseParameter::m_X)] == doctest::Approx(total[0]));
}
void check_weight() {
  CHECK(pushed_by(BaseParameter::W_B, 4.4)[2] == doctest::Approx(0.2));
  const Vehicle lbv = test::vehicle_from_repository("seabotix_lbv150");
  CHECK(nominal_model(lbv, true).theta[index(BaseParameter::W_B)] == doctest::Approx(-1.1881));  // Table 1.1
  CHECK(nearest_base(pap())[index(BaseParameter::W_B)] < 0.0);  // light: it is the chain that holds it down
}
void check_specific_force() {
  CHECK((specific_force(KinematicVector::Zero()) - Eigen::Vector3d(0, 0, -kGravity)).norm() < 1e-9);
}

}  // namespace

TEST_CASE("conventions: every sign that is stated is what the code does") {
  run("Signs", {{"Depth and `z` grow downward", check_angles},
                {"Drag derivatives (`X_u`", check_drag},
                {"Masses are totals", check_masses},
                {"`W-B` is weight minus buoyancy", check_weight},
                {"`G = r_G W - r_B B` [N m]",
                 [] {
                   const Vehicle vehicle = free_body();
                   Model model = body(vehicle);
                   model.theta[index(BaseParameter::G_z)] = 2.0;
                   CHECK(acceleration(model, rest(model, {0.2, 0, 0}))[3] < 0.0);  // rolled to starboard, it comes back
                   CHECK(pushed_by(BaseParameter::G_x, 1.0)[4] < 0.0);             // the bow goes down
                   CHECK(pushed_by(BaseParameter::G_y, 1.0)[3] > 0.0);             // starboard goes down
                   // Buoyancy above the centre of mass: r_B points up, z < 0.
                   CHECK(nearest_base(pap())[index(BaseParameter::G_z)] == doctest::Approx(0.022 * 866.0));
                 }},
                {"Residual wrench",
                 [] {
                   const Vehicle vehicle = free_body();
                   const Model model = body(vehicle);
                   const Vector6d more = (Vector6d{} << 1, 0, 0, 0, 0, 0).finished();  // m/s^2 that nothing explains
                   CHECK(residual_wrench(model, rest(model), more)[0] == doctest::Approx(12.0));
                 }},
                {"Specific force of an accelerometer at rest", check_specific_force},
                {"Current `v_N`", [] {
                   const Vehicle vehicle = free_body();
                   Model model = body(vehicle);
                   model.theta[index(BaseParameter::X_u)] = -6.0;
                   model.add({.effect = find_effect("current"), .variant = 0, .variant_name = "", .theta = {0.5, 0.0}});
                   Motion motion = rest(model);
                   std::vector<double> memory;
                   feel(model, motion, memory, 0.0);
                   CHECK(acceleration(model, motion)[0] > 0.0);  // carried north
                 }}});
}

TEST_CASE("conventions: both papers say the same in these words") {
  run("The two papers in these words",
      {{"axes forward, right, down",
        [] {
          for (const char* name : {"seabotix_lbv150", "pap104_half"}) {
            const Vehicle vehicle = test::vehicle_from_repository(name);
            CHECK(vehicle.thrusters[0].name == "port");
            CHECK(vehicle.thrusters[0].p_BJ.y() < 0.0);
            CHECK(vehicle.allocation(5, 0) > 0.0);  // ahead on port turns the bow to starboard
          }
        }},
       {"rates and angles as above",
        [] {
          check_angles();
          KinematicVector x = KinematicVector::Zero();
          x[at::kAngles + 1] = 0.3;
          // Level in roll, bow up: turning about the body's down axis turns the heading faster than itself.
          CHECK(KinematicPoint{x}.turn_from_angles.inverse()(2, 2) == doctest::Approx(1.0 / std::cos(0.3)));
        }},
       {"`m_X` = m - X_udot, positive", check_masses},
       {"drag derivatives that dissipate are negative",
        [] {
          check_drag();
          const Vehicle lbv = test::vehicle_from_repository("seabotix_lbv150");
          const Model table = nominal_model(lbv, true);
          CHECK(table.theta[index(BaseParameter::X_u)] == doctest::Approx(-8.604));
          const std::vector<ManoeuvringCoefficient> X_uu{{.term = gertler_submarine().find("X_uu"), .value = -0.03}};
          CHECK(manoeuvring_wrench(X_uu, {Vector6d::Unit(0)}, {.length = 1.35, .density = 1025.0})[0] < 0.0);
          CHECK(manoeuvring_wrench(X_uu, {-Vector6d::Unit(0)}, {.length = 1.35, .density = 1025.0})[0] < 0.0);
        }},
       {"N, N/(m/s), N/(m/s)^2",
        [] {
          const auto scale = [](const char* name) {
            return manoeuvring_scale(*gertler_submarine().find(name), {.length = 2.0, .density = 1000.0});
          };
          CHECK(scale("X_uu") == doctest::Approx(500.0 * 4));   // two velocities: L^2
          CHECK(scale("Y_ur") == doctest::Approx(500.0 * 8));   // one rate: L^3
          CHECK(scale("N_ur") == doctest::Approx(500.0 * 16));  // of a moment: one more
          CHECK(scale("X_rr") == doctest::Approx(500.0 * 16));
        }},
       {"`W-B` positive sinks", check_weight},
       {"specific force (0, 0, -g) at rest", check_specific_force},
       {"inertial acceleration a_O = v_dot + w x v",
        [] {
          const Eigen::Vector3d f = specific_force(circle_to_port());  // v_dot = 0, and yet
          CHECK(f.y() == doctest::Approx(-0.05));
        }},
       {"a circle to port has r < 0",
        [] {
          Manoeuvre circle = manoeuvre_preset("circle");
          circle.duration = 60.0;
          const FlightMoment last = fly(pap(), circle, 1.0).back();
          CHECK(last.nu[5] < 0.0);
          CHECK(last.nu[0] * last.nu[5] == doctest::Approx(-0.05).epsilon(0.1));
        }},
       {"`declination` is added to a compass heading", [] {
          KinematicVector x = KinematicVector::Zero();
          x[at::kAngles + 2] = 0.2;
          const Observation seen = observe_heading(KinematicPoint{x}, 0.05, 0.15, 1.0);
          CHECK(seen.innovation == doctest::Approx(0.0));
        }}});
}

}  // namespace fathom::model
