// Effects of oblique flow, of turning and of the world's steady forces, against hand-written formulas.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/vehicle_file.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

constexpr double kProductRounding = 1e-12;

Vector6d wrench_of(const std::string& name, const std::vector<double>& theta, int variant,
                   const model::Motion& motion) {
  model::Load load;
  model::find_effect(name)->load(motion, theta, variant, load);
  CHECK_FALSE(load.has_inertia());
  return load.wrench;
}

model::Motion moving() {
  model::Motion motion;
  motion.nu << 0.8, -0.3, 0.2, 0.1, -0.2, 0.4;
  return motion;
}

int variant_of(const std::string& effect, const std::string& form) {
  model::Vehicle vehicle;
  vehicle.dof = {true, true, true, true, true, true};
  vehicle.flow_matters = true;
  model::Scene scene{.vehicle = &vehicle};
  scene.nu_rms.setConstant(0.3);
  const auto names = model::find_effect(effect)->variants(scene);
  const auto found = std::ranges::find(names, form);
  REQUIRE(found != names.end());
  return static_cast<int>(found - names.begin());
}

}  // namespace

TEST_CASE("speed_drag: against the path with the square of the whole speed, and never gives power") {
  model::Motion motion = moving();
  const double speed = std::sqrt(0.64 + 0.09 + 0.04);
  CHECK(wrench_of("speed_drag", {5.0}, 1, motion)[1] == doctest::Approx(5.0 * speed * 0.3).epsilon(kProductRounding));
  CHECK(wrench_of("speed_drag", {5.0}, 5, motion)[5] == doctest::Approx(-5.0 * speed * 0.4).epsilon(kProductRounding));
  for (int axis = 0; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      motion.nu = sign * moving().nu;
      CHECK(motion.nu.dot(wrench_of("speed_drag", {3.0}, axis, motion)) < 0.0);
    }
  }
  motion.nu = moving().nu;  // it is the water's speed past the hull that counts
  motion.v_WF_B = motion.nu.head<3>();
  CHECK(wrench_of("speed_drag", {5.0}, 1, motion).isZero(0.0));
}

TEST_CASE("speed_drag: is asked of an axis only where others move too") {
  model::Vehicle vehicle;
  vehicle.dof = {true, true, false, false, false, true};
  vehicle.flow_matters = true;
  model::Scene scene{.vehicle = &vehicle};
  scene.nu_rms[0] = 0.5;
  CHECK(model::find_effect("speed_drag")->variants(scene).empty());
  scene.nu_rms[5] = 0.2;
  CHECK(model::find_effect("speed_drag")->variants(scene).back() == "N_|V|r");
  scene.nu_rms[1] = 0.1;
  CHECK(model::find_effect("speed_drag")->variants(scene)[0] == "X_|V|u");
  vehicle.flow_matters = false;
  vehicle.weight_moves = true;  // a glider
  CHECK_FALSE(model::find_effect("speed_drag")->variants(scene).empty());
  vehicle.weight_moves = false;  // an open frame: the file states neither fins nor propellers nor windage
  for (const char* name : {"speed_drag", "body_lift", "turning_resistance", "steady_force", "wind"}) {
    CAPTURE(name);
    CHECK(model::find_effect(name)->variants(scene).empty());
  }
}

TEST_CASE("body_lift: a product of the speed ahead, which turns round going astern or does not") {
  model::Motion motion = moving();
  const int munk = variant_of("body_lift", "N_uv"), fin = variant_of("body_lift", "Y_|u|v");
  CHECK(wrench_of("body_lift", {7.0}, munk, motion)[5] == doctest::Approx(7.0 * 0.8 * -0.3).epsilon(kProductRounding));
  CHECK(wrench_of("body_lift", {-7.0}, fin, motion)[1] == doctest::Approx(7.0 * 0.8 * 0.3).epsilon(kProductRounding));
  motion.nu[0] = -0.8;
  CHECK(wrench_of("body_lift", {7.0}, munk, motion)[5] == doctest::Approx(7.0 * 0.8 * 0.3).epsilon(kProductRounding));
  CHECK(wrench_of("body_lift", {-7.0}, fin, motion)[1] == doctest::Approx(7.0 * 0.8 * 0.3).epsilon(kProductRounding));
  const model::Effect& lift = *model::find_effect("body_lift");
  CHECK(lift.unit(munk, 0) == "N m/(m/s)^2");
  CHECK(lift.unit(variant_of("body_lift", "Y_ur"), 0) == "N/(m/s)/(rad/s)");
  CHECK(lift.unit(variant_of("body_lift", "M_uq"), 0) == "N m/(m/s)/(rad/s)");
}

TEST_CASE("body_lift: surfaces that stand one way lift with the water's angle at each of them") {
  model::Motion motion = moving();
  // Two surfaces, at 0.5 m and -2 m, of 3 and 8 N/(m/s)^2.
  const double sum = 3.0 + 8.0, at_x = 0.5 * 3.0 - 2.0 * 8.0, at_xx = 0.25 * 3.0 + 4.0 * 8.0;
  const std::vector<double> theta{0.0, sum, at_x, at_xx, 0.0, 0.0, 0.0, sum, at_x, at_xx, 0.0, 0.0, 0.0};
  const int sideways = variant_of("body_lift", "hull, sideways");
  const int upright = variant_of("body_lift", "hull, up and down");
  for (const double u : {0.8, -0.8}) {
    motion.nu[0] = u;
    Vector6d aside = Vector6d::Zero(), below = Vector6d::Zero();
    for (const auto& [x, lift] : {std::pair{0.5, 3.0}, std::pair{-2.0, 8.0}}) {
      const double y = -lift * 0.8 * (motion.nu[1] + x * motion.nu[5]);
      const double z = -lift * 0.8 * (motion.nu[2] - x * motion.nu[4]);
      aside[1] += y;
      aside[5] += x * y;
      below[2] += z;
      below[4] -= x * z;
    }
    CHECK((wrench_of("body_lift", theta, sideways, motion) - aside).norm() < kProductRounding);
    CHECK((wrench_of("body_lift", theta, upright, motion) - below).norm() < kProductRounding);
    CHECK(motion.nu.dot(aside + below) < 0.0);
  }
  CHECK(model::find_effect("body_lift")->traits().asked_first);
}

TEST_CASE("body_lift: a surface at an angle is drawn towards where it goes, in proportion to the square of the angle") {
  model::Motion motion = moving();
  const int sideways = variant_of("body_lift", "hull, sideways");
  // One surface of 8 N/(m/s)^2 at -2 m, half of whose suction is left.
  const std::vector<double> theta{0.0, 8.0, -16.0, 32.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (const double u : {0.8, -0.8}) {
    motion.nu[0] = u;
    const double across = motion.nu[1] - 2.0 * motion.nu[5];
    const double ahead = 0.5 * 8.0 * across * across * u / std::hypot(u, motion.nu[1]);
    CHECK(wrench_of("body_lift", theta, sideways, motion)[0] == doctest::Approx(ahead).epsilon(kProductRounding));
  }
}

namespace {

/// A fin aft, with a propeller before it or none.
model::Vehicle with_fin(int behind, double slipstream) {
  model::Vehicle craft;
  craft.dof = {true, true, false, false, false, true};
  craft.thrusters.resize(2);
  craft.thrusters[1].axis_B = Eigen::Vector3d::UnitY();
  craft.thrusters[1].p_BJ = {-1.0, 0.0, 0.0};
  craft.thrusters[1].fin =
      model::Fin{.slope = 40.0, .stall = 0.5, .reference_speed = 2.0, .behind = behind, .slipstream = slipstream};
  craft.allocation.setZero(6, 2);
  craft.allocation.col(0)[0] = craft.allocation.col(1)[1] = 1.0;
  craft.allocation.col(1)[5] = -1.0;
  craft.flow_matters = true;
  return craft;
}

/// Ahead + i aside [N] of a foil that goes through the water ahead and aside [m/s]: lift at a right angle to its way.
std::complex<double> foil(double deflection, std::complex<double> way, double leaning) {
  const double alpha = std::clamp(deflection - std::arg(way), -0.5, 0.5), lift = 10.0 * std::norm(way) * alpha;
  return way / std::abs(way) * std::complex<double>{-leaning * lift * alpha, lift};
}

int fin_form(const model::Vehicle& craft) {
  model::Scene scene{.vehicle = &craft};
  scene.nu_rms.setConstant(0.3);
  const auto names = model::find_effect("body_lift")->variants(scene);
  const auto found = std::ranges::find(names, "hull and fins, sideways");
  REQUIRE(found != names.end());
  CHECK(std::ranges::find(names, "hull, sideways") == names.end());
  return static_cast<int>(found - names.begin());
}

}  // namespace

TEST_CASE("body_lift: a fin that turns and drifts is a foil at its angle to the flow, as far as the stall") {
  const model::Vehicle craft = with_fin(-1, 0.0);
  const int form = fin_form(craft);
  model::Motion motion{.vehicle = &craft};
  motion.nu << 1.0, 0.1, 0.0, 0.0, 0.0, 0.3;  // at the fin 0.2 m/s to port
  std::vector<double> theta(model::find_effect("body_lift")->parameters().size(), 0.0);
  theta[5] = 0.6;  // D_S
  theta[6] = 1.0;  // F_S
  for (const double deflection : {0.0, 0.2, -0.3, 0.4, 0.5}) {
    CAPTURE(deflection);
    motion.force = Eigen::Vector2d(0.0, 40.0 * deflection);
    const Vector6d wrench = wrench_of("body_lift", theta, form, motion);
    const std::complex<double> whole = foil(deflection, {1.0, -0.2}, 0.6);
    CHECK(wrench[0] == doctest::Approx(whole.real()).epsilon(kProductRounding));
    // In straight flow at half of the reference speed the actuator gives a quarter of the force that is told.
    CHECK(wrench[1] + 10.0 * deflection == doctest::Approx(whole.imag()).epsilon(kProductRounding));
    CHECK(wrench[5] == doctest::Approx(-wrench[1]).epsilon(kProductRounding));
  }
  motion.nu << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;  // straight on, lift is the actuator's own and leans back alone
  motion.force = Eigen::Vector2d(0.0, 40.0 * 0.2);
  const Vector6d straight = wrench_of("body_lift", theta, form, motion);
  CHECK((straight + 0.6 * 10.0 * 0.2 * 0.2 * Vector6d::Unit(0)).norm() < kProductRounding);
}

TEST_CASE("body_lift: a fin in a propeller's wash resists being carried across, at rest too") {
  const model::Vehicle craft = with_fin(0, 0.1);
  const int form = fin_form(craft);
  model::Motion motion{.vehicle = &craft};
  std::vector<double> theta(model::find_effect("body_lift")->parameters().size(), 0.0);
  theta[6] = 0.9;  // F_S
  for (const double thrust : {25.0, -25.0}) {
    for (const double u : {0.0, 0.8}) {
      motion.force = Eigen::Vector2d(thrust, 0.0);
      motion.nu << u, 0.1, 0.0, 0.0, 0.0, 0.3;
      const double along = std::sqrt(u * u + (thrust > 0.0 ? 2.5 : 0.0));  // astern there is no wash on it
      const Vector6d wrench = wrench_of("body_lift", theta, form, motion);
      const std::complex<double> whole = 0.9 * foil(0.0, {along, -0.2}, 0.0);
      CHECK(wrench[1] == doctest::Approx(whole.imag()).epsilon(kProductRounding));
      CHECK(wrench[5] == doctest::Approx(-whole.imag()).epsilon(kProductRounding));
    }
  }
}

TEST_CASE("cross_flow: is what many strips do, less what a hull does that only drifts or only turns") {
  model::Vehicle torpedo;
  torpedo.dof = {true, true, true, false, true, true};
  torpedo.flow_matters = true;
  torpedo.hull << 1.6, 0.2, 0.2;
  model::Scene scene{.vehicle = &torpedo};
  scene.nu_rms << 1.0, 0.1, 0.1, 0.0, 0.2, 0.3;
  const model::Effect& effect = *model::find_effect("cross_flow");
  REQUIRE(effect.variants(scene)[0] == "sideways");
  REQUIRE(effect.variants(scene)[1] == "up and down");
  CHECK(effect.variants(scene)[2] == "-");
  CHECK(effect.starts(scene, 0).front()[2] == 1.6);
  const double c = 70.0, f = -20.0, length = 1.6;
  const auto square = [](double s) { return s * std::abs(s); };
  for (const double r : {0.0, 0.05, -0.4, 1.5}) {
    model::Motion motion{.vehicle = &torpedo};
    motion.nu << 1.2, 0.2, -0.1, 0.0, r, r;
    Vector6d aside = Vector6d::Zero(), below = Vector6d::Zero();
    constexpr int kStrips = 4000;
    for (int i = 0; i < kStrips; ++i) {
      const double x = length * ((i + 0.5) / kStrips - 0.5);
      const double strip = (c + f * x / (0.5 * length)) / kStrips;
      const double y = -strip * square(motion.nu[1] + x * r), z = -strip * square(motion.nu[2] - x * r);
      aside[1] += y;
      aside[5] += x * y;
      below[2] += z;
      below[4] -= x * z;
    }
    const double turning = c * length * length * length / 32.0;
    aside[1] += c * square(motion.nu[1]);
    aside[5] += turning * square(r);
    below[2] += c * square(motion.nu[2]);
    below[4] += turning * square(r);
    // Eight points miss the kink where a strip stands still: a hundredth of what is there.
    const double size = c * (0.05 + 0.32 * r * r);
    CHECK((wrench_of("cross_flow", {c, f, length}, 0, motion) - aside).norm() < 0.01 * size);
    CHECK((wrench_of("cross_flow", {c, f, length}, 1, motion) - below).norm() < 0.01 * size);
  }
  torpedo.hull.setZero();
  CHECK(effect.variants(scene)[0] == "-");
  CHECK(effect.variants(scene)[2] == "sideways, of a length");
  CHECK(effect.starts(scene, 2).size() == 3);
  CHECK(effect.rules_out(0, 2));
  CHECK_FALSE(effect.rules_out(0, 1));
}

TEST_CASE("oblique flow: is asked of a boat that nothing pushes sideways, and of no frame with a thruster across") {
  model::Vehicle boat;
  boat.dof = {true, true, false, false, false, true};
  boat.thrusters.resize(2);
  boat.allocation.setZero(6, 2);
  boat.allocation.row(0).setOnes();
  boat.allocation.row(5) << 0.3, -0.3;
  model::Scene scene{.vehicle = &boat};
  scene.nu_rms << 0.8, 0.1, 0.0, 0.0, 0.0, 0.3;
  CHECK_FALSE(model::find_effect("body_lift")->variants(scene).empty());
  boat.allocation(1, 0) = 0.5;
  CHECK(model::find_effect("body_lift")->variants(scene).empty());
}

TEST_CASE("turning_resistance: products of drift and turning load the way ahead") {
  const model::Motion motion = moving();
  const int vr = variant_of("turning_resistance", "X_vr"), qq = variant_of("turning_resistance", "X_qq");
  CHECK(wrench_of("turning_resistance", {11.0}, vr, motion)[0] ==
        doctest::Approx(11.0 * -0.3 * 0.4).epsilon(kProductRounding));
  CHECK(wrench_of("turning_resistance", {11.0}, qq, motion)[0] ==
        doctest::Approx(11.0 * 0.2 * 0.2).epsilon(kProductRounding));
  CHECK(model::find_effect("turning_resistance")->unit(qq, 0) == "N/(rad/s)^2");
}

TEST_CASE("steady_force: is the same in the world on every heading") {
  model::Motion motion = moving();
  for (const double heading : {0.0, 1.0, 3.0}) {
    motion.R_WB = Eigen::AngleAxisd{heading, Eigen::Vector3d::UnitZ()}.toRotationMatrix();
    const Eigen::Vector3d in_world = motion.R_WB * wrench_of("steady_force", {3.0, -2.0}, 0, motion).head<3>();
    CHECK((in_world - Eigen::Vector3d(3.0, -2.0, 0.0)).norm() < kProductRounding);
  }
}

TEST_CASE("wind: pushes with the square of the wind past the craft, and still air is none of it") {
  model::Vehicle vehicle;
  vehicle.windage = 2.0;
  model::Motion motion;
  motion.vehicle = &vehicle;
  constexpr double kPressure = 0.5 * 1.23 * 2.0;  // kg/m: times speed squared
  // From astern at 5 m/s on a craft at rest, then on one that runs before it at 1 m/s.
  CHECK(wrench_of("wind", {5.0, 0.0, 0.4, 0.0}, 0, motion)[0] ==
        doctest::Approx(0.6 * kPressure * 25.0).epsilon(kProductRounding));
  motion.nu[0] = 1.0;
  CHECK(wrench_of("wind", {5.0, 0.0, 0.4, 0.0}, 0, motion)[0] ==
        doctest::Approx(0.6 * kPressure * (16.0 + 1.0)).epsilon(kProductRounding));
  motion.nu.setZero();
  const Vector6d abeam = wrench_of("wind", {0.0, 4.0, 0.4, 0.0}, 0, motion);
  CHECK(abeam[1] == doctest::Approx(0.9 * kPressure * 16.0).epsilon(kProductRounding));
  CHECK(abeam[5] == doctest::Approx(0.4 * abeam[1]).epsilon(kProductRounding));
  // Nothing stands above the water of a craft whose file does not say so.
  vehicle.dof = {true, true, false, false, false, true};
  model::Scene scene{.vehicle = &vehicle, .attitude = true, .velocity = true};
  CHECK(model::find_effect("wind")->variants(scene) == std::vector<std::string>{"alike from all sides", "-"});
  vehicle.hull = {10.0, 2.0, 1.0};
  CHECK(model::find_effect("wind")->variants(scene) ==
        std::vector<std::string>{"alike from all sides", "the hull's side"});
  vehicle.windage = 0.0;
  CHECK(model::find_effect("wind")->variants(scene).empty());
}

TEST_CASE("wind: is asked of a boat whose file states no windage, unless it says that nothing stands out") {
  const auto windage = [](const std::string& more) {
    return model::vehicle_from(
               Config::parse("name: a\nmass: 55 kg\nwater_density: 1025 kg/m^3\nhull: 2 1 0.5 m\n" + more, "a.yaml"))
        .windage;
  };
  const std::string boat =
      "dof: [surge, sway, yaw]\nthrusters:\n  - {name: p, position: 0 -0.4 0 m, axis: 1 0 0}\n  - {name: s, position: "
      "0 0.4 0 m, axis: 1 0 0}\n";
  CHECK(windage(boat) == doctest::Approx(0.5));
  CHECK(windage(boat + "windage: 0.2 m^2\n") == 0.2);
  CHECK(windage(boat + "windage: 0 m^2\n") == 0.0);
  CHECK_THROWS_AS(static_cast<void>(windage(boat + "windage: -1 m^2\n")), InputError);
  // What is pushed sideways, and what dives, is none.
  CHECK(windage(boat + "  - {name: t, position: 0.5 0 0 m, axis: 0 1 0}\n") == 0.0);
  CHECK(windage("dof: [surge, sway, heave, yaw]\n" + boat.substr(boat.find('\n') + 1) +
                "  - {name: v, position: 0 0 0 m, axis: 0 0 1}\n") == 0.0);
}

TEST_CASE("wind: a hull's side takes less of it from ahead, and its centre of pressure goes toward the end blown on") {
  model::Vehicle vehicle;
  vehicle.windage = 2.0;
  vehicle.hull = {10.0, 2.0, 1.0};
  model::Motion motion;
  motion.vehicle = &vehicle;
  const std::vector<double> from_astern{5.0, 0.0, 0.0, 1.5}, quartering{3.0, 4.0, 0.0, 1.5};
  CHECK(wrench_of("wind", from_astern, 1, motion)[0] ==
        doctest::Approx(0.2 * wrench_of("wind", from_astern, 0, motion)[0]).epsilon(kProductRounding));
  const Vector6d pushed = wrench_of("wind", quartering, 1, motion);
  CHECK(pushed[5] == doctest::Approx(1.5 * 0.6 * pushed[1]).epsilon(kProductRounding));
}

}  // namespace fathom
