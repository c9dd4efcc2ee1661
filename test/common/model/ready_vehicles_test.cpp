// Vehicle files to begin with: all load, mean what their sources say, and their outputs are those of the autopilot's
// frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>

#include "common/model/driven_axes.hpp"
#include "common/model/parameters.hpp"
#include "common/model/vehicle.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

double mean_of(const Vehicle& vehicle, const std::string& parameter) {
  const auto found = std::ranges::find(vehicle.parameters, parameter);
  REQUIRE(found != vehicle.parameters.end());
  return vehicle.priors[static_cast<std::size_t>(found - vehicle.parameters.begin())].mean;
}

}  // namespace

TEST_CASE("ready vehicles: each loads, and water adds to its mass") {
  for (const char* name : {"bluerov2_heavy", "blueboat", "otter", "remus100", "slocum", "cybership2", "kvlcc2_l3"}) {
    CAPTURE(name);
    const Vehicle vehicle = test::vehicle_from_repository(name);
    for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
      if (vehicle.parameters[i].starts_with("m_")) CHECK(vehicle.priors[i].mean >= vehicle.mass);
    }
  }
}

TEST_CASE("ready vehicles: every file of the repository flies") {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{FATHOM_SOURCE_DIR "/config/vehicles"}) {
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    const Vehicle vehicle = test::vehicle_from_repository(name);
    const auto dive = test::make_dive(vehicle, {.duration = 20.0, .dt = 0.05, .seed = 3});
    double fastest = 0.0;
    for (const Vector6d& nu : dive.trial.nu) {
      REQUIRE(nu.allFinite());
      fastest = std::max(fastest, nu.cwiseAbs().maxCoeff());
    }
    CHECK(fastest > 1e-3);  // it moves
    CHECK(fastest < 10.0);  // m/s or rad/s: and no faster than any such craft
    ++files;
  }
  CHECK(files >= 12);
}

TEST_CASE("ready vehicles: the outputs of BlueROV2 Heavy push as ArduSub's frame VECTORED_6DOF says") {
  // Factors of AP_Motors6DOF for outputs 1 to 8: roll, pitch, yaw, throttle (up), forward, lateral (to starboard).
  constexpr std::array<std::array<double, 6>, 8> kFactors{{{0, 0, 1, 0, -1, 1},
                                                           {0, 0, -1, 0, -1, -1},
                                                           {0, 0, -1, 0, 1, 1},
                                                           {0, 0, 1, 0, 1, -1},
                                                           {1, -1, 0, -1, 0, 0},
                                                           {-1, -1, 0, -1, 0, 0},
                                                           {1, 1, 0, -1, 0, 0},
                                                           {-1, 1, 0, -1, 0, 0}}};
  const Vehicle heavy = test::vehicle_from_repository("bluerov2_heavy");
  REQUIRE(heavy.thrusters.size() == 8);
  const auto sign = [](double value) { return std::abs(value) < 1e-3 ? 0.0 : std::copysign(1.0, value); };
  for (std::size_t i = 0; i < 8; ++i) {
    CAPTURE(i);
    const auto column = heavy.allocation.col(static_cast<Eigen::Index>(i));
    CHECK(sign(column[0]) == kFactors[i][4]);
    CHECK(sign(column[1]) == kFactors[i][5]);
    CHECK(sign(column[2]) == -kFactors[i][3]);
    CHECK(sign(column[5]) == kFactors[i][2]);
    if (i < 4) continue;  // horizontal ones sit below the centre of mass: what they tilt, the frame leaves out
    CHECK(sign(column[3]) == kFactors[i][0]);
    CHECK(sign(column[4]) == kFactors[i][1]);
  }
  CHECK(undriven_note(heavy).empty());
}

TEST_CASE("ready vehicles: numbers that follow from others") {
  const Vehicle otter = test::vehicle_from_repository("otter");
  // 24.4 kgf at six knots: where linear drag alone takes up the pull of both propellers.
  CHECK(-mean_of(otter, "X_u") * 6.0 * 0.5144 == doctest::Approx(24.4 * 9.81).epsilon(0.01));
  CHECK(2.0 * otter.largest_thrust == doctest::Approx(24.4 * 9.81).epsilon(0.01));
  CHECK(undriven_note(otter).find("sway") != std::string::npos);
  // 8.2 kgf of both motors at rest: about what drag takes at the maker's top speed, and no less.
  const Vehicle boat = test::vehicle_from_repository("blueboat");
  CHECK(-3.0 * mean_of(boat, "X_u") - 9.0 * mean_of(boat, "X_u|u|") == doctest::Approx(8.2 * 9.81).epsilon(0.01));
  CHECK(2.0 * boat.largest_thrust == doctest::Approx(8.2 * 9.81).epsilon(0.01));
  // The printed non-dimensional numbers of the MMG standard method with 0.5 rho L d.
  const Vehicle ship = test::vehicle_from_repository("kvlcc2_l3");
  const double area = 0.5 * 1000.0 * 2.909 * 0.189;  // kg/m
  CHECK(mean_of(ship, "m_X") == doctest::Approx(235.0 + 0.022 * area * 2.909).epsilon(1e-3));
  CHECK(mean_of(ship, "m_Y") == doctest::Approx(235.0 + 0.223 * area * 2.909).epsilon(1e-3));
  CHECK(mean_of(ship, "X_u|u|") == doctest::Approx(-0.022 * area).epsilon(1e-3));
  CHECK(mean_of(ship, "Y_v") == doctest::Approx(-0.315 * area * 0.76).epsilon(1e-3));
  CHECK(mean_of(ship, "N_r") == doctest::Approx(-0.049 * area * 2.909 * 2.909 * 0.76).epsilon(1e-3));
  const Vehicle remus = test::vehicle_from_repository("remus100");
  CHECK(remus.thrusters.size() == 3);
  CHECK(undriven_note(remus).find("roll") != std::string::npos);
  CHECK(mean_of(remus, "m_Y") == mean_of(remus, "m_Z"));
  CHECK(mean_of(remus, "G_z") == doctest::Approx(0.0196 * 299.0).epsilon(0.01));
  const Vehicle glider = test::vehicle_from_repository("slocum");
  CHECK(mean_of(glider, "Z_w") == doctest::Approx(-132.5 * 0.35).epsilon(0.01));
}

}  // namespace fathom::model
