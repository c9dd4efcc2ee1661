// Thrusters in each other's jets, jets that meet the hull, torque, and what the surface does: against formulas by hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kRounding = 1e-12;

/// Two thrusters on one line along x, the second 0.5 m behind the first, and one across behind both.
model::Vehicle tandem() {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  vehicle.thrusters.resize(3);
  const auto place = [&](std::size_t i, const char* name, const Eigen::Vector3d& p, const Eigen::Vector3d& axis) {
    vehicle.thrusters[i].name = name;
    vehicle.thrusters[i].p_BJ = p;
    vehicle.thrusters[i].axis_B = axis;
  };
  place(0, "fore", {0.3, 0.0, 0.0}, Eigen::Vector3d::UnitX());
  place(1, "aft", {-0.2, 0.0, 0.0}, Eigen::Vector3d::UnitX());
  place(2, "across", {-0.6, 0.05, 0.0}, Eigen::Vector3d::UnitY());
  vehicle.allocation.resize(6, 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const model::Thruster& one = vehicle.thrusters[static_cast<std::size_t>(i)];
    vehicle.allocation.col(i) << one.axis_B, one.p_BJ.cross(one.axis_B);
  }
  return vehicle;
}

struct Fixture {
  model::Vehicle vehicle = tandem();
  model::Motion motion;
  model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};

  Fixture() {
    motion.vehicle = &vehicle;
    motion.force = Eigen::Vector3d(9.0, 4.0, 16.0);
    scene.force_rms = Eigen::Vector3d::Constant(5.0);
    scene.nu_rms.setConstant(0.3);
    scene.tau_rms.setConstant(5.0);
    scene.p_low.z() = 0.5;
    scene.p_high.z() = 1.5;
  }
  /// The variant that this vehicle calls so.
  [[nodiscard]] int form(const char* effect, const std::string& name) const {
    const auto names = model::find_effect(effect)->variants(scene);
    const auto found = std::ranges::find(names, name);
    REQUIRE_MESSAGE(found != names.end(), effect, " has no form ", name);
    return static_cast<int>(found - names.begin());
  }
  [[nodiscard]] Eigen::Vector3d felt(const char* effect, const std::vector<double>& theta, int variant) const {
    model::Motion copy = motion;
    model::find_effect(effect)->feel(copy, theta, variant, {});
    return copy.force;
  }
};

}  // namespace

TEST_CASE(
    "thruster_wake: behind a thruster that pushes ahead one loses by the roots of both, and nothing the other way") {
  Fixture fixture;
  const int aft = fixture.form("thruster_wake", "aft in the jet of fore");
  CHECK(fixture.felt("thruster_wake", {0.5}, aft).isApprox(Eigen::Vector3d(9.0, 4.0 - 0.5 * 6.0, 16.0), kRounding));
  fixture.motion.force[1] = -4.0;  // against the jet that comes: it meets more of its own inflow, and pushes harder
  CHECK(fixture.felt("thruster_wake", {0.5}, aft)[1] == doctest::Approx(-4.0 - 3.0));
  fixture.motion.force[0] = -9.0;  // the jet leaves forward
  CHECK(fixture.felt("thruster_wake", {0.5}, aft) == Eigen::Vector3d(-9.0, -4.0, 16.0));
  const int fore = fixture.form("thruster_wake", "fore in the jet of aft");
  CHECK(fixture.felt("thruster_wake", {0.5}, fore)[0] == doctest::Approx(-9.0 + 3.0));
}

TEST_CASE(
    "thruster_wake: a jet that crosses weakens whichever way one pushes; all pairs act by what was pushed before") {
  Fixture fixture;
  const int across = fixture.form("thruster_wake", "across in the jet of aft");
  CHECK(fixture.felt("thruster_wake", {0.25}, across)[2] == doctest::Approx(16.0 - 0.25 * 8.0));
  fixture.motion.force[2] = -16.0;
  CHECK(fixture.felt("thruster_wake", {0.25}, across)[2] == doctest::Approx(-16.0 + 0.25 * 8.0));
  const Eigen::Vector3d all = fixture.felt("thruster_wake", {0.25}, fixture.form("thruster_wake", "all"));
  CHECK(all[1] == doctest::Approx(4.0 - 0.25 * 6.0));
  CHECK(all[2] == doctest::Approx(-16.0 + 0.25 * (8.0 + 12.0)));  // aft's jet as pushed, and fore's behind it
}

TEST_CASE("thruster_wake: where jets pass by, or places are not known, there is nothing to ask") {
  const model::Vehicle beside = test::vehicle_from_repository("bluerov2_heavy");
  model::Scene scene{.vehicle = &beside};
  CHECK(model::find_effect("thruster_wake")->variants(scene).empty());
  const model::Vehicle unplaced = test::vehicle_from_repository("beluga");
  scene.vehicle = &unplaced;
  CHECK(model::find_effect("thruster_wake")->variants(scene).empty());
}

TEST_CASE("jet_on_hull: a share of one way's push; both ways of one thruster are one thruster's gain") {
  Fixture fixture;
  const model::Effect& effect = *model::find_effect("jet_on_hull");
  const int ahead = fixture.form("jet_on_hull", "aft ahead"), astern = fixture.form("jet_on_hull", "aft astern");
  CHECK(fixture.felt("jet_on_hull", {0.25}, ahead) == Eigen::Vector3d(9.0, 3.0, 16.0));
  CHECK(fixture.felt("jet_on_hull", {0.25}, astern) == Eigen::Vector3d(9.0, 4.0, 16.0));
  fixture.motion.force[1] = -4.0;
  CHECK(fixture.felt("jet_on_hull", {0.25}, astern) == Eigen::Vector3d(9.0, -3.0, 16.0));
  CHECK(effect.rules_out(ahead, astern));
  CHECK_FALSE(effect.rules_out(ahead, fixture.form("jet_on_hull", "fore astern")));
}

TEST_CASE("propeller_torque: a moment about the propeller's axis by its thrust, and no force") {
  Fixture fixture;
  model::Load load;
  const model::Effect& effect = *model::find_effect("propeller_torque");
  effect.load(fixture.motion, std::vector{-0.02}, fixture.form("propeller_torque", "fore"), load);
  CHECK(load.wrench.isApprox((Vector6d() << 0.0, 0.0, 0.0, -0.18, 0.0, 0.0).finished(), kRounding));
  load.clear();
  fixture.vehicle.dof[4] = true;
  effect.load(fixture.motion, std::vector{-0.02}, fixture.form("propeller_torque", "all"), load);
  CHECK(load.wrench.isApprox((Vector6d() << 0.0, 0.0, 0.0, -0.26, -0.32, 0.0).finished(), kRounding));
}

TEST_CASE("propeller_torque: of a propeller that loses thrust under way the torque falls by a line of its own") {
  Fixture fixture;
  fixture.vehicle.thrusters[0].inflow = 0.4;
  fixture.motion.nu[0] = 2.0;  // 0.4 sqrt(9) 2 = 2.4 N of 9 N are lost
  model::Load load;
  const model::Effect& effect = *model::find_effect("propeller_torque");
  const int form = fixture.form("propeller_torque", "fore");
  CHECK(effect.numbers(form) == 2);
  effect.load(fixture.motion, std::vector{-0.02, -0.01}, form, load);
  CHECK(load.wrench[3] == doctest::Approx(-0.02 * 6.6 - 0.01 * 2.4).epsilon(kRounding));
}

TEST_CASE("propeller_torque: where a file states the allocation alone, its columns tell the axes") {
  model::Vehicle beluga = test::vehicle_from_repository("beluga");
  beluga.dof = {true, true, true, false, false, true};
  const auto names = model::find_effect("propeller_torque")->variants({.vehicle = &beluga});
  for (std::size_t i = 0; i < beluga.thrusters.size(); ++i) {
    CAPTURE(beluga.thrusters[i].name);
    const auto place = static_cast<Eigen::Index>(i);
    const bool upright = std::abs(beluga.allocation(2, place)) > 0.5;
    CHECK((std::ranges::find(names, beluga.thrusters[i].name) != names.end()) == upright);  // turns it in yaw
    model::Motion motion{.vehicle = &beluga};
    motion.force = Eigen::VectorXd::Zero(beluga.allocation.cols());
    motion.force[place] = 5.0;
    model::Load load;
    model::find_effect("propeller_torque")->load(motion, std::vector{0.01}, static_cast<int>(i) + 1, load);
    CHECK((load.wrench.tail<3>() - 0.05 * beluga.allocation.col(place).head<3>()).norm() < kRounding);
  }
}

TEST_CASE("switching_moment: comes whole with a step of thrust, about an axis not driven, and fades in its time") {
  Fixture fixture;
  const model::Effect& effect = *model::find_effect("switching_moment");
  const int roll = fixture.form("switching_moment", "fore about x");
  const std::vector<double> theta{0.05, 0.5};
  std::vector<double> z(2);
  fixture.motion.force[0] = 1.0;
  effect.settle(fixture.motion, theta, roll, z);
  const auto moment = [&] {
    model::Motion felt = fixture.motion;
    felt.w_memory.setZero();
    effect.feel(felt, theta, roll, z);
    CHECK(felt.w_memory.head<3>().isZero(0.0));
    return felt.w_memory[3];
  };
  CHECK(moment() == 0.0);
  fixture.motion.force[0] = 9.0;
  for (int i = 0; i < 25; ++i) {
    CAPTURE(i);
    effect.advance(fixture.motion, theta, roll, 0.02, z);
    CHECK(moment() == doctest::Approx(0.05 * 8.0 * std::exp(-0.02 * (i + 1) / 0.5)));
  }
  CHECK(std::ranges::count(effect.variants(fixture.scene), "across about z") ==
        0);  // it turns the vehicle in yaw itself
}

TEST_CASE("ventilation: by each propeller's own depth, whole at most, nothing far below") {
  Fixture fixture;
  const model::Effect& effect = *model::find_effect("ventilation");
  CHECK(effect.variants(fixture.scene).size() == 1);
  fixture.motion.p_WB.z() = 1.0;
  fixture.motion.R_WB = rotation_from_euler({0.0, -0.5, 0.0});  // bow down: what is ahead lies deeper
  const std::vector<double> theta{0.4, 0.25, 0.5};
  const Eigen::Vector3d felt = fixture.felt("ventilation", theta, 0);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double deeper = (fixture.motion.R_WB * fixture.vehicle.thrusters[static_cast<std::size_t>(i)].p_BJ).z();
    CHECK(felt[i] == doctest::Approx(fixture.motion.force[i] * (1.0 - 0.4 * std::exp(-(1.0 + deeper - 0.5) / 0.25))));
  }
  fixture.motion.p_WB.z() = -1.0;
  CHECK(fixture.felt("ventilation", theta, 0).isZero(0.0));
  fixture.motion.p_WB.z() = 30.0;
  CHECK(fixture.felt("ventilation", theta, 0).isApprox(Eigen::Vector3d(fixture.motion.force), kRounding));
  fixture.scene.p_low.z() = 8.0;
  fixture.scene.p_high.z() = 12.0;
  CHECK(effect.variants(fixture.scene).empty());
}

TEST_CASE("surface_effect: the bottom's laws seen in a mirror that lies level") {
  const Fixture fixture;
  const model::Effect &surface = *model::find_effect("surface_effect"), &bottom = *model::find_effect("bottom_effect");
  const auto names = surface.variants(fixture.scene);
  REQUIRE(names == bottom.variants(fixture.scene));
  const auto load_of = [](const model::Effect& effect, const std::vector<double>& theta, int v, double z, double w) {
    model::Motion motion;
    motion.p_WB.z() = z;
    motion.nu << 0.6, -0.2, w, 0.1, 0.1, 0.1;
    model::Load load;
    load.drag = -4.0 * motion.nu;
    effect.load(motion, theta, v, load);
    return load.wrench;
  };
  for (int v = 0; v < static_cast<int>(names.size()); ++v) {
    CAPTURE(names[static_cast<std::size_t>(v)]);
    Vector6d mirrored = load_of(bottom, {2.0, 3.0, 0.4, 2.0}, v, 1.2, 0.3);
    mirrored[2] = -mirrored[2];
    const Vector6d above = load_of(surface, {2.0, -3.0, 0.4, -2.0}, v, -1.2, -0.3);
    CHECK((above - mirrored).head<3>().norm() < kRounding);
    CHECK(above.norm() > 0.01);
    for (const auto& start : surface.starts(fixture.scene, v)) CHECK(start[1] <= fixture.scene.p_low.z());
    if (v < 2) CHECK_FALSE(surface.possible(std::vector{2.0, 1.4, 0.4, 0.5}, v, fixture.scene));  // below the middle
  }
  CHECK(surface.looks_like(std::vector{2.0, 0.0, 0.4, 0.5}, 2, fixture.scene).what == "lighter water above the depths visited");
}
