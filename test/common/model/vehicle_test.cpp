#include "common/model/vehicle.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <regex>
#include <stdexcept>
#include <string>

#include "common/base/error.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/parameters.hpp"
#include "common/model/priors/physical_bounds.hpp"
#include "common/tables/import.hpp"
#include "test/support/scratch.hpp"

using fathom::InputError;
using fathom::Vector6d;
using fathom::model::Vehicle;

namespace {

constexpr double kRounding = 1e-12;  // sums of a few products

std::string vehicle_file(const std::string& name) {
  return std::string(FATHOM_SOURCE_DIR) + "/config/vehicles/" + name + ".yaml";
}

// A box with four horizontal thrusters in line with its axes, enough for surge, sway and yaw.
const std::string kHead = "name: Box\nwater_density: 1000 kg/m^3\nmass: 8 kg\n";
const std::string kThrusters =
    "thrusters:\n"
    "  - {name: port, position: 0 -0.2 0 m, axis: 1 0 0}\n"
    "  - {name: starboard, position: 0 0.2 0 m, axis: 1 0 0}\n"
    "  - {name: bow, position: 0.3 0 0 m, axis: 0 1 0}\n";

Vehicle parse(const std::string& yaml) {
  const fathom::test::Scratch scratch;  // cases run side by side
  const std::string path = scratch.path("vehicle_test.yaml");
  fathom::test::write_bytes(path, yaml);
  return Vehicle::load(path);
}

// The complaint without the folder: "vehicle_test.yaml:3: ...".
std::string complaint(const std::string& yaml) {
  try {
    static_cast<void>(parse(yaml));
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("vehicle_test.yaml"));
  }
  return "no complaint";
}

double prior_mean(const Vehicle& vehicle, const std::string& name) {
  const auto found = std::find(vehicle.parameters.begin(), vehicle.parameters.end(), name);
  REQUIRE(found != vehicle.parameters.end());
  return vehicle.priors[static_cast<std::size_t>(found - vehicle.parameters.begin())].mean;
}

}  // namespace

TEST_CASE("vehicle: a free axis without thrust of its own is accepted and named") {
  const std::string pair =
      "thrusters:\n  - {name: port, position: -0.5 -0.25 0 m, axis: 1 0 0}\n"
      "  - {name: starboard, position: -0.5 0.25 0 m, axis: 1 0 0}\n";
  const Vehicle boat = parse(kHead + "dof: [surge, sway, yaw]\n" + pair);
  CHECK(driven_axes(boat) == std::array<bool, 6>{true, false, false, false, false, true});
  CHECK(undriven_note(boat).starts_with("Box: sway moves freely, without thrust of its own"));
  CHECK(undriven_note(parse(kHead + "dof: [surge, yaw]\n" + pair)).empty());
  CHECK(undriven_note(parse(kHead + "dof: [surge, sway, yaw]\n" + kThrusters)).empty());
}

TEST_CASE("vehicle: what no vehicle has is refused, with the line, the bound and its reason") {
  CHECK(complaint("name: Box\ndof: [surge]\nwater_density: 1000 kg/m^3\nmass: 1e300 kg\n") ==
        "vehicle_test.yaml:4: 'mass' of 1e+300 kg is beyond what there is: at most 1e+09 kg (the largest ship there "
        "was is "
        "458 m long and 6.6e8 kg heavy); is the unit right?");
  const auto refused = [&](const std::string& lines, const std::string& words) {
    const std::string said = complaint(kHead + "dof: [surge]\n" + kThrusters + lines);
    CAPTURE(lines);
    CHECK_MESSAGE(said.find(words) != std::string::npos, said);
  };
  refused("hull: 1 1e4 1 m\n", "'hull' of 10000 m is beyond");
  refused("inertia: 1e20 1e20 1e20 kg m^2\n", "'inertia' of 1e+20 kg m^2");
  refused("largest_thrust: 1e-9 N\n", "'largest_thrust' of 1e-09 N is below");
  refused("priors: {X_u: {mean: -1e200 N/(m/s), sigma: 1 N/(m/s)}}\n", "'mean' of -1e+200 N/(m/s)");
  refused("priors: {X_u: {mean: -1 N/(m/s), sigma: 1e200 N/(m/s)}}\n", "'sigma' of 1e+200 N/(m/s)");
  refused("sensors: {ahrs: {position: 0 0 1e9 m}}\n", "'position' of 1e+09 m");
  refused("sensors: {ahrs: {position: 0 0 1 m, rotation: 1e6 0 0 rad}}\n", "'rotation' of 1e+06 rad");
  // In the file's own unit, too: a gram for a kilogram is caught where it makes a difference that nobody has.
  CHECK(complaint("name: Box\ndof: [surge]\nwater_density: 1 kg/m^3\nmass: 8 kg\n").find("at least 900 kg/m^3") !=
        std::string::npos);
}

TEST_CASE("vehicle: numbers that are possible each and not together are refused at the mass or the inertia") {
  const auto said = [](const std::string& mass, const std::string& lines) {
    return complaint("name: Box\nwater_density: 1000 kg/m^3\nmass: " + mass + "\ndof: [surge]\n" + lines);
  };
  const std::string hull = "hull: 0.9 0.7 0.35 m\n";  // 0.2205 m^3: 0.441 kg at 2 kg/m^3, 4410 kg at 2e4
  CHECK(said("13 g", hull) ==
        "vehicle_test.yaml:3: 'mass' of 0.013 kg is no more than the air in this 'hull' weighs: at least 0.441 kg; are "
        "the units of both right?");
  CHECK(said("0.45 kg", hull) == "no complaint");
  CHECK(said("4500 kg", hull).find("all tungsten: at most 4.41e+03 kg") != std::string::npos);
  CHECK(said("4400 kg", hull) == "no complaint");
  // Without a hull the thrust alone tells: three thrusters of 50 N are 150 N, 300 m/s^2 of half a kilogram.
  const std::string thrust = kThrusters + "largest_thrust: 50 N\n";
  CHECK(said("13 g", thrust).find("too little for 150 N of thrust") != std::string::npos);
  CHECK(said("0.49 kg", thrust).find("at least 0.5 kg") != std::string::npos);
  CHECK(said("0.51 kg", thrust) == "no complaint");
  // 24 kg in the corners of 0.9 m by 0.7 m, six times: 46.8 kg m^2.
  CHECK(said("24 kg", hull + "inertia: 40 40 46 kg m^2\n").starts_with("vehicle_test.yaml:6: 'inertia' of 40 kg m^2"));
  CHECK(said("24 kg", hull + "inertia: 20 20 39 kg m^2\n") == "no complaint");
}

TEST_CASE("physical bounds: every row has a reason, a span and a value that it refuses") {
  namespace model = fathom::model;
  for (const model::PhysicalBound& row : model::physical_bounds()) {
    const std::string key{row.key}, unit{row.unit};
    CAPTURE(key);
    CAPTURE(unit);
    CHECK(row.reason.size() > 5);
    CHECK(row.least < row.most);
    CHECK(std::ranges::count_if(model::physical_bounds(), [&](const model::PhysicalBound& each) {
            return each.key == row.key && each.unit == row.unit;
          }) == 1);
    for (const double sign : {1.0, -1.0}) {
      CHECK(model::beyond_physics(key, unit, sign * row.most).empty());
      CHECK_FALSE(model::beyond_physics(key, unit, 1.01 * sign * row.most).empty());
    }
    if (row.least > 0.0) CHECK_FALSE(model::beyond_physics(key, unit, 0.99 * row.least).empty());
  }
  CHECK_THROWS_AS((void)model::beyond_physics("mass", "furlong", 1.0), std::logic_error);
}

TEST_CASE("physical bounds: whatever reads a vehicle file reads its numbers within them") {
  const std::regex unbounded{R"(\b\w+\.(quantity|quantities|positive|not_negative|vector3)\()"};
  for (const std::string room : {"vehicle", "mounts", "lens", "hydrodynamics", "after_abort"}) {
    std::ifstream file{std::string{FATHOM_SOURCE_DIR} + "/common/model/" + room + ".cpp"};
    REQUIRE(file);
    for (std::string line; std::getline(file, line);) {
      CAPTURE(room);
      CHECK_MESSAGE(!std::regex_search(line, unbounded), line);
    }
  }
}

TEST_CASE("vehicle: thruster columns are axis and position cross axis") {
  const Vehicle vehicle = parse(kHead + "dof: [surge, sway, yaw]\n" + kThrusters);
  REQUIRE(vehicle.allocation.cols() == 3);
  Vector6d port;
  port << 1, 0, 0, 0, 0, 0.2;
  Vector6d bow;
  bow << 0, 1, 0, 0, 0, 0.3;
  CHECK(vehicle.allocation.col(0).isApprox(port, kRounding));
  CHECK(vehicle.allocation.col(2).isApprox(bow, kRounding));
  CHECK(vehicle.has_thrusters());
  CHECK(vehicle.curve.empty());
}

TEST_CASE("vehicle: enabled motions decide the parameters, and silence gives wide priors of the right sign") {
  const Vehicle vehicle = parse(kHead + "dof: [surge, roll]\n");
  CHECK_FALSE(vehicle.has_thrusters());
  CHECK(vehicle.allocation.cols() == 0);
  CHECK(vehicle.parameters == std::vector<std::string>{"m_X", "I_X", "X_u", "K_p", "X_u|u|", "K_p|p|", "G_y", "G_z"});
  REQUIRE(vehicle.priors.size() == 8);
  CHECK(prior_mean(vehicle, "m_X") == doctest::Approx(12.0));
  // L = 2 cbrt(8/1000) = 0.4 m: 1/2 1000 0.16 = 80.
  CHECK(prior_mean(vehicle, "X_u|u|") == doctest::Approx(-80.0));
  CHECK(prior_mean(vehicle, "X_u") == doctest::Approx(-40.0));
  CHECK(prior_mean(vehicle, "K_p|p|") == doctest::Approx(-0.16));
  for (const auto& prior : vehicle.priors) CHECK(prior.sigma > 0.0);
}

TEST_CASE(
    "vehicle: what drifts unpowered is felt by what is driven: its mass, and the net weight of a vehicle that tilts") {
  const auto has = [](const Vehicle& vehicle, const char* name) {
    return std::ranges::count(vehicle.parameters, name) == 1;
  };
  const Vehicle torpedo = parse(kHead + "dof: [surge, pitch, yaw]\n");  // m_Y r v, (m_Z - m_X) u w, (W-B) sin theta
  for (const char* felt : {"m_X", "m_Y", "m_Z", "W-B", "I_X"}) CHECK(has(torpedo, felt));
  for (const char* own : {"Y_v", "Z_w", "K_p", "Y_v|v|"}) CHECK_FALSE(has(torpedo, own));
  const Vehicle level = parse(kHead + "dof: [surge, heave, yaw]\n");
  CHECK(has(level, "m_Y"));
  const Vehicle planar = parse(kHead + "dof: [surge, sway, yaw]\n");
  for (const char* still : {"m_Z", "W-B"}) CHECK_FALSE(has(planar, still));
  const Vehicle bearing = parse(kHead + "dof: [roll, pitch, yaw]\n");
  for (const char* still : {"m_X", "m_Y", "m_Z", "W-B"}) CHECK_FALSE(has(bearing, still));
}

TEST_CASE("vehicle: impossible things are refused with file and line") {
  const std::string dof = "dof: [surge, sway, yaw]\n";
  const auto begins = [](const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; };
  CHECK(complaint("name: B\ndof: [surge]\nwater_density: 1000 kg/m^3\nmass: -1 kg\n") ==
        "vehicle_test.yaml:4: 'mass' must be positive, not -1 kg");
  CHECK(complaint(kHead + dof + "inertia: 1 1 3 kg m^2\n") ==
        "vehicle_test.yaml:5: no rigid body has this inertia: the largest moment exceeds the sum of the other two");
  CHECK(complaint(kHead + dof + "inertia: 1 0 1 kg m^2\n") ==
        "vehicle_test.yaml:5: 'inertia' must be positive about every axis");
  CHECK(complaint(kHead + dof + "inertia: 1 1 2 kg m^2\n") == "no complaint");
  const std::string hull =
      "hull: 0.6 0.8 0.2 m\npriors:\n";  // corners 0.5 m from the vertical: 8 kg there are 2 kg m^2
  CHECK(
      complaint(kHead + dof + hull + "  I_Z: {mean: 12.1 kg m^2, sigma: 1 kg m^2}\n") ==
      "vehicle_test.yaml:7: 'I_Z' of 12.1 kg m^2 is impossible: with this 'mass' and 'hull', water included, it is at "
      "most 12 kg m^2; correct one of the three");
  CHECK(complaint(kHead + dof + hull + "  I_Z: {mean: 11.9 kg m^2, sigma: 1 kg m^2}\n") == "no complaint");
  CHECK(complaint(kHead + "dof: [heave]\n" + kThrusters) ==
        "vehicle_test.yaml:5: the thrusters push along none of the axes in 'dof'; correct their geometry");
  CHECK(complaint(kHead + dof + "thrusters:\n  - {name: a, position: 0 0 0 m, axis: 0 0 0}\n") ==
        "vehicle_test.yaml:6: 'axis' must be a unit vector; its length is 0");
  CHECK(complaint(kHead + dof + "thrusters:\n  - {name: a, position: 0 0 0 m, axis: 1 1 0}\n") ==
        "vehicle_test.yaml:6: 'axis' must be a unit vector; its length is 1.414214");
  CHECK(complaint(kHead + dof + "thrusters:\n  - {name: a}\n") ==
        "vehicle_test.yaml:5: every thruster needs position and axis, unless 'allocation' is given");
  CHECK(complaint(kHead + "dof: [surge, surge]\n") == "vehicle_test.yaml:4: 'surge' stands here twice");
  CHECK(begins(complaint(kHead + "dof: [forward]\n"), "vehicle_test.yaml:4: 'forward' is no degree of freedom"));
  CHECK(complaint(kHead + "dof: []\n") == "vehicle_test.yaml:4: at least one degree of freedom must be free");
  CHECK(complaint(kHead + dof + "priors:\n  m_X: {mean: 3 N, sigma: 1 kg}\n") ==
        "vehicle_test.yaml:6: 'mean': unit 'N' does not fit: expected 'kg'");
  CHECK(begins(complaint(kHead + dof + "priors:\n  X_u: {mean: 3 N/(m/s), sigma: 1 N/(m/s)}\n"),
               "vehicle_test.yaml:6: 'X_u' must not be positive"));
  CHECK(begins(complaint(kHead + dof + "priors:\n  Z_w: {mean: -3 N/(m/s), sigma: 1 N/(m/s)}\n"),
               "vehicle_test.yaml:6: 'Z_w' has a prior but is not enabled"));
  CHECK(begins(complaint(kHead + dof + "parameters: [X_w]\n"), "vehicle_test.yaml:5: 'X_w' is no base parameter"));
  CHECK(begins(complaint("name: B\ndof: [surge]\nwater_density: 1000 kg/m^3\n"),
               "vehicle_test.yaml:1: state the 'mass'"));
  CHECK(complaint(kHead + dof + "bouyancy: 3 N\n") ==
        "vehicle_test.yaml:5: unknown key 'bouyancy'; did you mean 'buoyancy'?");
}

TEST_CASE("vehicle: a thrust curve must rise, and is mirrored, scaled and held at its ends") {
  const auto with_curve = [&](const std::string& pwm, const std::string& force) {
    return kHead + "dof: [surge, sway, yaw]\n" + kThrusters + "thrust_curve:\n  neutral: 1500 us\n  voltage: 16 V\n" +
           "  voltage_exponent: 2\n  pwm: " + pwm + " us\n  force: " + force + " N\n";
  };
  const Vehicle vehicle = parse(with_curve("1100 1500 1700 1900", "-20 0 10 40"));
  CHECK(vehicle.curve.force_at(1500.0) == 0.0);
  CHECK(vehicle.curve.force_at(1800.0) == doctest::Approx(25.0));
  CHECK(vehicle.curve.force_at(1000.0) == -20.0);
  CHECK(vehicle.curve.force_at(2500.0) == 40.0);
  CHECK(vehicle.curve.force_at(1300.0, -1.0, 16.0) == doctest::Approx(10.0));
  CHECK(vehicle.curve.force_at(1300.0, 1.0, 8.0) == doctest::Approx(-2.5));
  CHECK(complaint(with_curve("1100 1500 1700", "-20 0 -1")).rfind("vehicle_test.yaml:14: 'force' must never fall", 0) ==
        0);
  CHECK(complaint(with_curve("1500 1100 1700", "-20 0 1")) ==
        "vehicle_test.yaml:13: 'pwm' must rise: 1100 follows 1500");
  CHECK(complaint(with_curve("1100 1500 1700", "-20 0")) ==
        "vehicle_test.yaml:14: 'pwm' has 3 numbers and 'force' has 2");
}

TEST_CASE("vehicle: a typed allocation must fit the thrusters it describes") {
  const auto with_rows = [&](const std::string& n) {
    return kHead + "dof: [surge, sway, yaw]\n" + kThrusters + "allocation:\n  X: 1 1 0\n  Y: 0 0 1\n  Z: 0 0 0\n" +
           "  K: 0 0 0 m\n  M: 0 0 0 m\n  N: " + n + " m\n";
  };
  CHECK(parse(with_rows("0.2 -0.2 0.3")).allocation(5, 1) == -0.2);
  CHECK(complaint(with_rows("0.2 -0.2")) == "vehicle_test.yaml:15: row N has 2 numbers for 3 thrusters");
  CHECK(complaint(with_rows("-0.2 0.2 0.3")) ==
        "vehicle_test.yaml:15: row N contradicts the positions and axes of the thrusters");
}

TEST_CASE("beluga: the allocation is the team's matrix with y and z of forces and moments turned over") {
  const Vehicle vehicle = Vehicle::load(vehicle_file("beluga"));
  REQUIRE(vehicle.thrusters.size() == 8);
  CHECK(vehicle.parameters.size() == 22);
  // Copied from test/data/beluga/README.md (forward-left-up).
  Eigen::Matrix<double, 6, 8> flu;
  flu << .70711, 0, 0, .70711, .70711, 0, 0, .70711,  //
      .70711, 0, 0, -.70711, .70711, 0, 0, -.70711,   //
      0, 1, 1, 0, 0, 1, 1, 0,                         //
      0, -.22, -.22, 0, 0, .22, .22, 0,               //
      .065, -.24, .24, .065, .065, .24, -.24, .065,   //
      .32557, 0, 0, .32557, -.32557, 0, 0, -.32557;
  const Vector6d turned = (Vector6d() << 1, -1, -1, 1, -1, -1).finished();
  CHECK(vehicle.allocation.isApprox(turned.asDiagonal() * flu, kRounding));
  // All verticals at +1 N push up (z down: negative); thrusters 0 and 3 against 4 and 7 turn to port (negative N).
  Eigen::VectorXd force = Eigen::VectorXd::Zero(8);
  force << 0, 1, 1, 0, 0, 1, 1, 0;
  CHECK((vehicle.allocation * force).isApprox((Vector6d() << 0, 0, -4, 0, 0, 0).finished(), kRounding));
  force << 1, 0, 0, 1, -1, 0, 0, -1;
  CHECK((vehicle.allocation * force)(5) == doctest::Approx(-4.0 * 0.32557));
}

TEST_CASE("seabotix: four motions and the paper's thirteen parameters") {
  const Vehicle vehicle = Vehicle::load(vehicle_file("seabotix_lbv150"));
  CHECK(vehicle.parameters == std::vector<std::string>{"m_X", "m_Y", "m_Z", "I_Z", "X_u", "Y_v", "Z_w", "N_r", "X_u|u|",
                                                       "Y_v|v|", "Z_w|w|", "N_r|r|", "W-B"});
  // Cross products by hand: port (0,0,+0.0475), starboard -0.0475, vertical 0, lateral +0.05.
  CHECK(vehicle.allocation.row(5).isApprox(Eigen::RowVector4d(0.0475, -0.0475, 0.0, 0.05), kRounding));
  CHECK(vehicle.allocation.row(2).isApprox(Eigen::RowVector4d(0.0, 0.0, 1.0, 0.0), kRounding));
  CHECK(prior_mean(vehicle, "W-B") == -1.1881);
}

// Eq. 1.6 lists port, starboard, vertical, lateral (the tau of 1.7: port, starboard, lateral, vertical).
TEST_CASE("seabotix: printed 1.6 with printed 1.7 books ten newtons of the vertical thruster as sway and yaw") {
  const Vehicle vehicle = Vehicle::load(vehicle_file("seabotix_lbv150"));
  const Eigen::Vector4d only_vertical{0.0, 0.0, 10.0, 0.0};
  Eigen::Matrix4d printed;        // rows X, Y, Z, N
  printed << 1.0, 1.0, 0.0, 0.0,  //
      0.0, 0.0, 1.0, 0.0,         //
      0.0, 0.0, 0.0, 1.0,         //
      0.0475, -0.0475, 0.05, 0.0;
  const Eigen::Vector4d wrong = printed * only_vertical;
  CHECK(wrong[1] == doctest::Approx(10.0));
  CHECK(wrong[3] == doctest::Approx(0.5));
  const Vector6d right = vehicle.allocation * only_vertical;  // by hand: (0 0 -0.05) x (0 0 10) is nothing
  CHECK((right - (Vector6d{} << 0.0, 0.0, 10.0, 0.0, 0.0, 0.0).finished()).norm() < 1e-12);
  // With the columns in the order of the inputs the numbers themselves are right.
  printed.col(2).swap(printed.col(3));
  for (Eigen::Index column = 0; column < 4; ++column) {
    const Eigen::Vector4d rows = vehicle.allocation({0, 1, 2, 5}, column);
    CHECK((printed.col(column) - rows).norm() < 1e-12);
  }
}

TEST_CASE("bluerov2: the file loads and its thrusters reach every motion it names") {
  const Vehicle vehicle = Vehicle::load(vehicle_file("bluerov2"));
  CHECK(vehicle.thrusters.size() == 6);
  CHECK(vehicle.dof == std::array<bool, 6>{true, true, true, true, false, true});
  CHECK(vehicle.curve.force_at(1500.0) == 0.0);
}

TEST_CASE("base parameters: every name is found again") {
  CHECK_FALSE(fathom::model::parameter_from_name("X_v").has_value());
  for (const auto one : fathom::model::base_parameters()) {
    CHECK(fathom::model::parameter_from_name(fathom::model::name(one)) == one);
    CHECK_FALSE(fathom::model::unit(one).empty());
  }
}

TEST_CASE("beluga: the thrust curve gives back the wrench that was logged, from command and voltage alone") {
  constexpr double kForceRms =
      0.3;  // N: found 0.20 to 0.24 per axis; the tail comes from interpolation on the 10 Hz grid
  constexpr double kMomentRms = 0.15;  // N m: found 0.06 to 0.11
  const Vehicle vehicle = Vehicle::load(vehicle_file("beluga"));
  const std::string root = FATHOM_SOURCE_DIR;
  Vector6d square = Vector6d::Zero();
  double count = 0.0;
  for (const char* run : {"surge-1", "sway-1", "heave-1", "yaw-1", "random-1", "random-2"}) {
    const auto imported =
        fathom::tables::import_csv(root + "/test/data/beluga/" + run + ".csv", root + "/config/maps/beluga.yaml");
    const auto& recording = imported.recording;
    REQUIRE(recording.battery.size() == recording.thrusters.size());
    for (std::size_t k = 0; k < recording.thrusters.size(); ++k) {
      const fathom::Thrusters& sample = recording.thrusters[k];
      Eigen::VectorXd force(8);
      for (std::size_t j = 0; j < 8; ++j) {
        force[static_cast<Eigen::Index>(j)] =
            vehicle.curve.force_at(sample.pwm_us[j], vehicle.thrusters[j].pwm_sign, recording.battery[k].voltage);
      }
      const Vector6d error = vehicle.allocation * force - Eigen::Map<const Vector6d>(sample.tau.data());
      square += error.cwiseAbs2();
      count += 1.0;
    }
  }
  const Vector6d rms = (square / count).cwiseSqrt();
  MESSAGE("wrench from commands, RMS error per axis: " << rms.transpose());
  CHECK(rms.head<3>().maxCoeff() < kForceRms);
  CHECK(rms.tail<3>().maxCoeff() < kMomentRms);
}
