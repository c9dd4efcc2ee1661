// Standard sets with the numbers that are published of vehicles, against other programs' integration of the same
// equations (turns of ships), closed forms (a glider's steady glide) and sums by hand (a torpedo).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/model/actuators.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/effect.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/model/manoeuvring/standard_set.hpp"
#include "common/model/scene.hpp"
#include "common/model/vehicle.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kEvery = 0.1;  // s

Vehicle mariner() { return Vehicle::load(FATHOM_SOURCE_DIR "/test/data/vehicles/mariner.yaml"); }

Manoeuvre turn_of(const Vehicle& vehicle, double rudder, double rate) {
  Manoeuvre manoeuvre = manoeuvre_for(vehicle, "circle");
  manoeuvre.rudder = rudder;
  manoeuvre.rudder_rate = rate;
  return manoeuvre;
}

/// Without its effects.
Model nominal(Model model) {
  model.effects.clear();
  return model;
}

/// Nothing but velocities, level; the actuators give nothing.
Motion moving(const Vehicle& vehicle, const Vector6d& nu) {
  Motion motion{.nu = nu};
  motion.force = ActuatorForces::Zero(static_cast<Eigen::Index>(vehicle.thrusters.size()));
  motion.vehicle = &vehicle;
  return motion;
}

}  // namespace

TEST_CASE("standard sets: each has a name, a source, terms of its own names, and says which motions it describes") {
  CHECK(standard_sets().size() >= 6);
  for (const StandardSet* set : standard_sets()) {
    CAPTURE(set->name);
    CHECK(find_standard_set(set->name) == set);
    CHECK(set->source.size() > 8);
    CHECK(static_cast<bool>(set->pushed));
    for (const ManoeuvringTerm& term : set->terms) {
      CAPTURE(term.name);
      CHECK(set->find(term.name) == &term);  // no name twice
      CHECK(set->moves[static_cast<std::size_t>(term.axis)]);
      CHECK((term.other >= 0) == (term.beside != nullptr));
      CHECK(term.value(Vector6d{Vector6d::Zero()}) == (term.name.ends_with("_prop") ? 1.0 : 0.0));  // rest, no NaN
    }
  }
  CHECK(find_standard_set("mmg_4") == nullptr);
  CHECK(standard_set_names().find("abkowitz_3, mmg_3") != std::string::npos);
}

TEST_CASE("standard sets: the Mariner's turn by its published series is that of another program") {
  // The equations of mariner.m (T. I. Fossen's Marine Systems Simulator) integrated apart: 100 s straight ahead, then
  // 15 deg of rudder at 5 deg/s. By then its propeller has turned it to starboard somewhat: Y_0, N_0.
  const Vehicle ship = mariner();
  Manoeuvre manoeuvre = turn_of(ship, 15.0 * kDegree, 5.0 * kDegree);
  manoeuvre.straight = 100.0;
  const auto flight = fly(ship, manoeuvre, kEvery);
  const TurnFigures turn = turn_figures(flight, manoeuvre);
  REQUIRE(turn.tactical_diameter);
  CHECK(turn.radius == doctest::Approx(711.0).epsilon(0.005));
  CHECK(*turn.advance == doctest::Approx(947.0).epsilon(0.01));
  CHECK(*turn.transfer == doctest::Approx(573.2).epsilon(0.01));
  CHECK(*turn.tactical_diameter == doctest::Approx(1344.7).epsilon(0.01));
  CHECK(flight.back().nu.head<2>().norm() == doctest::Approx(6.63).epsilon(0.01));
  CHECK(flight.back().nu[5] < 0.0);  // a circle goes to port
  // The IMO's standard of ships: advance within 4.5 lengths at full rudder. The Mariner keeps it.
  Manoeuvre hard = turn_of(ship, 35.0 * kDegree, 5.0 * kDegree);
  hard.straight = 100.0;
  CHECK(*turn_figures(fly(ship, hard, kEvery), hard).advance / 160.93 == doctest::Approx(4.24).epsilon(0.02));
}

TEST_CASE("standard sets: a tanker's turn by the MMG method is that of the method's equations") {
  // Integrated by another program from the paper's equations and tables (the whole open-water curve; ours is a straight
  // line): advance 3.09, transfer 1.33, tactical diameter 3.10 lengths, at last 1.13 lengths, 19 deg and .38 of the
  // speed. Other programs quote 2.9 to 3.3 lengths, either way, of free-running models.
  const Vehicle ship = test::vehicle_from_repository("kvlcc2_l3");
  const double length = ship.hydrodynamics->length;
  const Manoeuvre manoeuvre = turn_of(ship, 35.0 * kDegree, 24.0 * kDegree);
  const auto flight = fly(ship, manoeuvre, kEvery);
  const TurnFigures turn = turn_figures(flight, manoeuvre);
  REQUIRE(turn.tactical_diameter);
  CHECK(*turn.advance / length == doctest::Approx(3.09).epsilon(0.03));
  CHECK(*turn.transfer / length == doctest::Approx(1.33).epsilon(0.05));
  CHECK(*turn.tactical_diameter / length == doctest::Approx(3.10).epsilon(0.04));
  CHECK(turn.radius / length == doctest::Approx(1.13).epsilon(0.05));
  const Vector6d& nu = flight.back().nu;
  CHECK(std::atan2(std::abs(nu[1]), nu[0]) / kDegree == doctest::Approx(19.2).epsilon(0.05));
  CHECK(nu.head<2>().norm() / ship.hydrodynamics->cruise == doctest::Approx(0.384).epsilon(0.05));
  // Before the rudder is put over, its propeller keeps the speed and the course is straight.
  for (const FlightMoment& m : flight) {
    if (m.t >= manoeuvre.straight) break;
    CHECK(m.nu[0] == doctest::Approx(0.76).epsilon(1e-3));
    CHECK(std::abs(m.nu[1]) < 1e-6);
    CHECK(m.nu.segment<3>(2).norm() == 0.0);  // heave, roll, pitch: not described
  }
  // Its zigzag overshoots: the heading goes on after the rudder is turned back.
  Manoeuvre zigzag = manoeuvre_for(ship, "zigzag");
  zigzag.rudder = zigzag.swing = 10.0 * kDegree;
  double most = 0.0;
  for (const FlightMoment& m : fly(ship, zigzag, kEvery))
    most = std::max(most, std::abs(euler_from_rotation(m.q_WB.toRotationMatrix()).z()));
  CHECK(most > 15.0 * kDegree);
  CHECK(most < 30.0 * kDegree);
}

TEST_CASE("standard sets: a glider glides where its closed form says") {
  // Graver 2005: angle of attack and speed of a steady glide at the angle xi.
  const Vehicle glider = test::vehicle_from_repository("slocum");
  constexpr double kD0 = 2.15, kD = 25.0, kL = 132.5, xi = -25.0 * kDegree, net = 1.2;  // N heavy
  const double alpha =
      0.5 * kL / kD * std::tan(xi) * (-1.0 + std::sqrt(1.0 - 4.0 * kD / (kL * kL) * kD0 / std::pow(std::tan(xi), 2)));
  const double V = std::sqrt(net / (-std::sin(xi) * (kD0 + kD * alpha * alpha) + std::cos(xi) * kL * alpha));
  const double theta = xi + alpha;
  Motion motion = moving(glider, Vector6d::Zero());
  motion.nu[0] = V * std::cos(alpha);
  motion.nu[2] = V * std::sin(alpha);
  motion.R_WB = rotation_from_euler({0.0, theta, 0.0});
  const Eigen::Vector3d F_weight_B = net * motion.R_WB.row(2).transpose();
  const Vector6d water = hull_wrench(glider, motion);
  CHECK(alpha / kDegree == doctest::Approx(2.1).epsilon(0.1));
  CHECK(V == doctest::Approx(0.45).epsilon(0.1));
  CHECK((water.head<3>() + F_weight_B).norm() < 1e-9);
  // The Munk moment of its added masses and its own: nose down where it sinks.
  CHECK(water[4] == doctest::Approx((70.0 - 5.0) * motion.nu[0] * motion.nu[2] - 100.0 * alpha * V * V));
}

TEST_CASE("standard sets: a torpedo's wrench is that of its equations, its fins' by their angles") {
  const Vehicle remus = test::vehicle_from_repository("remus100");
  Vector6d nu;
  nu << 1.5, 0.1, -0.05, 0.2, 0.03, -0.1;
  Motion motion = moving(remus, nu);
  const Vector6d free = hull_wrench(remus, motion);
  CHECK(free[0] == doctest::Approx(-1.62 * 2.25 - 35.5 * -0.05 * 0.03 - 1.93 * 9e-4 + 35.5 * 0.1 * -0.1 - 1.93 * 0.01));
  CHECK(free[1] == doctest::Approx(-131 * 0.01 + 0.632 * -0.01 - 28.6 * 0.15 + 35.5 * -0.05 * 0.2 + 5.22 * -0.15 +
                                   1.93 * 0.2 * 0.03));
  CHECK(free[3] == doctest::Approx(-0.13 * 0.04));
  // Ten degrees: what the actuator gives is not counted twice.
  const double angle = 10.0 * kDegree;
  motion.force[1] = angle * remus.thrusters[1].fin->slope;
  motion.force[2] = angle * remus.thrusters[2].fin->slope;
  const Vector6d more = hull_wrench(remus, motion) - free;
  CHECK(more[1] == doctest::Approx(9.64 * 2.25 * angle));
  CHECK(more[2] == doctest::Approx(-9.64 * 2.25 * angle));
  CHECK(more[4] == doctest::Approx(-6.15 * 2.25 * angle));
  CHECK(more[5] == doctest::Approx(-6.15 * 2.25 * angle));
  CHECK(remus.hydrodynamics->set->pushed(remus, motion).norm() == 0.0);
  // The same fins as actuators, in straight flow: his pair of fins to one percent.
  const Vector6d by_area = acting_wrench(remus, moving(remus, 1.5 * Vector6d::Unit(0)));
  CHECK(by_area.norm() == 0.0);
  CHECK(remus.thrusters[1].fin->slope / (1.51 * 1.51) == doctest::Approx(9.64).epsilon(0.01));
}

TEST_CASE("standard sets: drag along each axis with added mass is the base model") {
  Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  Hydrodynamics& h = *vehicle.hydrodynamics;
  h.set = find_standard_set("fossen_lumped");
  h.coefficients.clear();
  for (const char* name : {"X_u", "Y_v", "N_r", "X_u|u|", "Y_v|v|", "M_q|q|"})
    h.coefficients.push_back({.term = h.set->find(name), .value = -20.0});
  Vector6d nu;
  nu << 0.5, -0.2, 0.1, 0.3, -0.1, 0.2;
  const Vector6d wrench = hull_wrench(vehicle, moving(vehicle, nu));
  Model base = nominal_model(vehicle, true);
  base.theta.setZero();
  base.theta.head<6>() = h.added_mass.diagonal();
  base.theta[index(BaseParameter::X_u)] = base.theta[index(BaseParameter::X_u) + 1] = -20.0;
  base.theta[index(BaseParameter::X_u) + 5] = base.theta[index(BaseParameter::X_uu)] = -20.0;
  base.theta[index(BaseParameter::X_uu) + 1] = base.theta[index(BaseParameter::X_uu) + 4] = -20.0;
  Motion motion = moving(vehicle, nu);
  motion.force = ActuatorForces::Zero(6);
  Load load;
  CHECK((generalised_force(base, motion, load) - wrench).norm() < 1e-12);
}

TEST_CASE("standard sets: beside a base model of the same masses, what was published is whole") {
  const Effect& lift = *find_effect("body_lift");
  std::vector<double> as_published(lift.parameters().size(), 0.0);
  as_published.back() = 1.0;
  REQUIRE(lift.parameters().back().name == "share");
  for (const char* name : {"remus100", "kvlcc2_l3", "slocum"}) {
    CAPTURE(name);
    Vehicle vehicle = test::vehicle_from_repository(name);
    Hydrodynamics& h = *vehicle.hydrodynamics;
    h.added_mass = Matrix6d{h.added_mass.diagonal().asDiagonal()};  // a base model has no more
    h.p_BG.setZero();
    Model base = nominal_model(vehicle, false);
    base.theta = nearest_base(vehicle);
    Vector6d nu;
    nu << 0.7, 0.05, -0.04, 0.02, 0.03, -0.06;
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (!h.set->moves[static_cast<std::size_t>(i)]) nu[i] = 0.0;
    }
    Motion motion = moving(vehicle, nu);
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) motion.force[i] = 0.3 + 0.1 * static_cast<double>(i);
    const Vector6d published = rigid_wrench(vehicle, Eigen::Vector3d::UnitZ(), nu) + hull_wrench(vehicle, motion) +
                               h.set->pushed(vehicle, motion);
    // Drag along each axis by its own velocity belongs to the base model: of a series, what it gives alone.
    Load load;
    Vector6d told = generalised_force(base, motion, load);
    for (Eigen::Index i = 0; i < 6; ++i) {
      TermMotion alone{nu[i] * Vector6d::Unit(i)};
      told[i] +=
          manoeuvring_wrench(h.coefficients, alone, h.lengths(vehicle.water_density))[i] - hull_drag(base, nu)[i];
    }
    CHECK((told - published).norm() > 0.01 * published.norm());
    base.add({&lift, lift.form_count() - 1, "as published", as_published});
    Vector6d with = generalised_force(base, motion, load) + told - generalised_force(nominal(base), motion, load);
    for (Eigen::Index i = 0; i < 6; ++i) {
      CAPTURE(i);
      if (h.set->moves[static_cast<std::size_t>(i)]) CHECK(with[i] == doctest::Approx(published[i]).epsilon(1e-9));
    }
  }
}

TEST_CASE("standard sets: what was published is asked of who names it, and of no other") {
  const auto asked = [](const Vehicle& vehicle) {
    Scene scene{.vehicle = &vehicle};
    scene.nu_rms.setConstant(0.3);
    scene.tau_rms.setConstant(1.0);
    return find_effect("body_lift")->variants(scene);
  };
  Vehicle ship = test::vehicle_from_repository("kvlcc2_l3");
  CHECK(asked(ship).back() == "as published: mmg_3");
  ship.hydrodynamics->named = false;
  CHECK(asked(ship).back() == "-");
  CHECK(asked(test::vehicle_from_repository("pap104_half")).empty());  // a truth of ours, of an open frame
}

TEST_CASE("standard sets: who names none that there is, or leaves out what it needs, is told in one line") {
  const test::Scratch scratch;
  const auto refused = [&](const std::string& more) -> std::string {
    const std::string path = scratch.path("ship.yaml");
    test::write_bytes(path, "name: A\ndof: [surge, sway, yaw]\nmass: 10 kg\nwater_density: 1000 kg/m^3\n" + more);
    try {
      static_cast<void>(Vehicle::load(path));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no complaint";
  };
  const std::string rest = "  length: 2 m\n  added_mass: 1 1 1 kg\n  added_inertia: 1 1 1 kg m^2\n";
  CHECK(refused("hydrodynamics:\n  model: mmg\n" + rest).find("'mmg' is no standard set; they are fossen_lumped") !=
        std::string::npos);
  CHECK(refused("hydrodynamics:\n  model: mmg_3\n" + rest).find("needs the 'draught'") != std::string::npos);
  const std::string ship = "hydrodynamics:\n  model: mmg_3\n  draught: 1 m\n" + rest;
  CHECK(refused(ship) == "no complaint");
  CHECK(refused(ship + "  interaction: {eta: 2}\n").find("'eta' must lie from 0 to 1") != std::string::npos);
  CHECK(refused(ship + "  interaction: {w_P: 1}\n").find("'w_P' is less than 1") != std::string::npos);
  CHECK(refused(ship + "  interaction: {C_2: 1 2 3}\n").find("'C_2' is one number, or two") != std::string::npos);
  CHECK(refused(ship + "  interaction: {eta: .nan}\n") != "no complaint");
  CHECK(refused(ship + "  rigid_coriolis: inside\n").find("is apart or among_coefficients") != std::string::npos);
  CHECK(refused(ship + "  cruise: 5 kg\n").find("cruise") != std::string::npos);
  CHECK(refused("hydrodynamics:\n  model: abkowitz_3\n" + rest).find("state it as 'cruise'") != std::string::npos);
  CHECK(refused("hydrodynamics:\n" + rest + "  coefficients: {Y_vvv: 1}\n")
            .find("'Y_vvv' is no coefficient of gertler") != std::string::npos);
}

}  // namespace fathom::model
