// Effects that depend on where the vehicle is: bottom, walls, a tether's length.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/dynamics.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kPlacesRounding = 1e-12;

model::Load load_of(const char* name, const std::vector<double>& theta, int variant, const model::Motion& motion) {
  model::Load load;
  load.drag << -4.0 * motion.nu.head<3>(), Eigen::Vector3d::Constant(-7.0);
  model::find_effect(name)->load(motion, theta, variant, load);
  return load;
}

model::Scene scene_in_a_tank(const model::Vehicle& vehicle) {
  model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.p_low = {-2.0, -1.0, 0.5};
  scene.p_high = {2.0, 1.0, 1.5};
  scene.nu_rms.setConstant(0.3);
  scene.tau_rms.setConstant(5.0);
  scene.force_rms = Vector6d::Constant(5.0);
  return scene;
}

}  // namespace

TEST_CASE("bottom_effect: pushes up along the world's vertical as the inverse square of the height") {
  model::Motion motion;
  motion.p_WB.z() = 3.0;
  motion.R_WB = rotation_from_euler({0.4, -0.3, 2.0});
  const model::Load far = load_of("bottom_effect", {8.0, 5.0}, 0, motion);
  CHECK((motion.R_WB * far.wrench.head<3>() - Eigen::Vector3d(0.0, 0.0, -2.0)).norm() < kPlacesRounding);
  motion.p_WB.z() = 4.0;
  CHECK((motion.R_WB * load_of("bottom_effect", {8.0, 5.0}, 0, motion).wrench.head<3>()).z() == doctest::Approx(-8.0));
  // Touching, and below it: as close as it gets, and finite.
  motion.p_WB.z() = 6.0;
  CHECK(load_of("bottom_effect", {8.0, 5.0}, 0, motion).wrench.head<3>().norm() == doctest::Approx(800.0));
}

TEST_CASE("bottom_effect: its drag is the hull's own once more for each square of a metre, without moments") {
  model::Motion motion;
  motion.p_WB.z() = 4.5;
  motion.nu << 0.6, 0.0, 0.8, 0.1, 0.1, 0.1;
  const model::Load load = load_of("bottom_effect", {2.0, 5.0}, 1, motion);
  CHECK((load.wrench.head<3>() + 2.0 / 0.25 * 4.0 * Eigen::Vector3d(0.6, 0.0, 0.8)).norm() < kPlacesRounding);
  CHECK(load.wrench.tail<3>().isZero(0.0));
}

TEST_CASE("bottom_effect: one floor obeys one law, and its exponential push is that of denser water not reached") {
  const model::Effect& bottom = *model::find_effect("bottom_effect");
  constexpr int kForce = 0, kDrag = 1, kExponentialForce = 2, kExponentialDrag = 3;
  CHECK(bottom.rules_out(kForce, kExponentialForce));
  CHECK(bottom.rules_out(kExponentialDrag, kDrag));
  CHECK_FALSE(bottom.rules_out(kForce, kExponentialDrag));
  CHECK(bottom.rules_out(kForce, 4));                                                    // suction
  CHECK_FALSE(model::find_effect("wall_effect")->rules_out(kForce, kExponentialForce));  // a tank has four

  constexpr double kStep = 90.0, kDepth = 3.0, kThickness = 0.3;  // N, m, m: buoyancy rises as a tanh of depth
  for (double z = 1.0; z < kDepth - 2.0 * kThickness; z += 0.1) {
    model::Motion motion;
    motion.p_WB.z() = z;
    const double layer = -load_of("layered_water", {kStep, kDepth, kThickness, 0.0}, 0, motion).wrench.z();
    const auto load = load_of("bottom_effect", {kStep, 0.0, 0.5 * kThickness, kDepth}, kExponentialForce, motion);
    CHECK(-load.wrench.z() == doctest::Approx(layer).epsilon(0.02));  // its tail: exp(-4) of it is missing
  }
  CHECK_FALSE(bottom.looks_like(std::vector{kStep, 0.0, 0.15, kDepth}, kExponentialForce, {}).what.empty());
  CHECK(bottom.looks_like(std::vector{-kStep, 0.0, 0.15, kDepth}, kExponentialForce, {}).what.empty());  // suction
  CHECK(bottom.looks_like(std::vector{kStep, 5.0, 0.0, 0.0}, kForce, {}).what.empty());
}

TEST_CASE("layered_water: lifts by its step below the edge, by half within it, along the world's vertical") {
  const auto push = [](double z) {
    model::Motion motion;
    motion.p_WB.z() = z;
    motion.R_WB = rotation_from_euler({0.4, -0.3, 2.0});
    return Eigen::Vector3d(motion.R_WB * load_of("layered_water", {6.0, 2.0, 0.1, 0.0}, 0, motion).wrench.head<3>());
  };
  CHECK(push(0.5).norm() < kPlacesRounding);
  CHECK((push(2.0) - Eigen::Vector3d(0.0, 0.0, -3.0)).norm() < kPlacesRounding);
  CHECK((push(3.5) - Eigen::Vector3d(0.0, 0.0, -6.0)).norm() < kPlacesRounding);
  CHECK(push(1.9).z() + push(2.1).z() == doctest::Approx(-6.0));  // odd about its edge

  // With the flanks of diffusion, an error function.
  constexpr double kDiffusion = 0.07, kOfWidth = 1.0 / 1.129, kClose = 5e-4, kWidth = 0.3;
  for (double x = -3.0; x < 3.0; x += 0.1) {
    model::Motion motion;
    motion.p_WB.z() = 2.0 + kWidth * x;
    const model::Load load = load_of("layered_water", {1.0, 2.0, kOfWidth * kWidth, kDiffusion}, 0, motion);
    CHECK(std::abs(load.wrench.z() + 0.5 * std::erfc(-x)) < kClose);
  }

  // Stirred above: nothing there, and the rest of the step falls off below.
  const auto below = [](double z) {
    model::Motion motion;
    motion.p_WB.z() = z;
    return -load_of("layered_water", {6.0, 2.0, 0.5, 0.0}, 1, motion).wrench.z();
  };
  CHECK(below(1.9) == 0.0);
  CHECK(below(2.5) == doctest::Approx(6.0 * (1.0 - std::exp(-1.0))));
  CHECK(below(20.0) == doctest::Approx(6.0));
}

TEST_CASE("layered_water: an edge that was not come near, a mere slope and lighter water below are none") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::Scene scene = scene_in_a_tank(vehicle);  // from .5 to 1.5 m deep
  const model::Effect& layer = *model::find_effect("layered_water");
  CHECK(layer.possible(std::vector{6.0, 1.2, 0.1, 0.0}, 0, scene));
  CHECK_FALSE(layer.possible(std::vector{-6.0, 1.2, 0.1, 0.0}, 0, scene));
  CHECK_FALSE(layer.possible(std::vector{6.0, 1.7, 0.1, 0.0}, 0, scene));
  CHECK_FALSE(layer.possible(std::vector{6.0, 0.4, 0.1, 0.0}, 0, scene));
  CHECK_FALSE(layer.possible(std::vector{6.0, 1.0, 0.6, 0.0}, 0, scene));
  for (const int form : {0, 1})
    for (const auto& start : layer.starts(scene, form)) CHECK(layer.possible(start, form, scene));
  CHECK(layer.rules_out(0, 1));
  model::Scene shallow = scene;
  shallow.p_high.z() = shallow.p_low.z() + 0.2;
  CHECK(layer.variants(shallow).empty());
}

TEST_CASE("bottom and wall: what takes drag away, or lies behind the vehicle, is no boundary") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::Scene scene = scene_in_a_tank(vehicle);  // middle at the origin, 1 m deep
  const model::Effect& bottom = *model::find_effect("bottom_effect");
  const model::Effect& wall = *model::find_effect("wall_effect");
  CHECK(bottom.possible(std::vector{-8.0, 2.0, 0.0, 0.0}, 0, scene));  // a push either way
  CHECK(bottom.possible(std::vector{2.0, 2.0, 0.0, 0.0}, 1, scene));
  CHECK_FALSE(bottom.possible(std::vector{-2.0, 2.0, 0.0, 0.0}, 1, scene));  // more drag, of one sign
  CHECK_FALSE(bottom.possible(std::vector{2.0, 0.9, 0.0, 0.0}, 1, scene));
  CHECK(wall.possible(std::vector{8.0, 0.0, 2.1, 0.0, 0.0}, 0, scene));
  CHECK_FALSE(wall.possible(std::vector{8.0, 0.0, -0.1, 0.0, 0.0}, 0, scene));
}

TEST_CASE("bottom and wall: a hull is drawn toward what it passes by, with the square of its speed along it alone") {
  constexpr int kSuction = 4;
  model::Motion motion;
  motion.p_WB = {1.0, 3.0, 4.5};
  motion.R_WB = rotation_from_euler({0.0, 0.0, 0.5 * std::numbers::pi});  // looking at the wall in the east
  motion.nu << 0.3, 0.4, 0.0, 0.1, 0.1, 0.1;
  const model::Load wall = load_of("wall_effect", {8.0, 0.5 * std::numbers::pi, 5.0, 0.0, 0.0}, kSuction, motion);
  CHECK((wall.wrench.head<3>() - Eigen::Vector3d(8.0 * 0.16 / 16.0, 0.0, 0.0)).norm() < kPlacesRounding);
  const model::Load floor = load_of("bottom_effect", {2.0, 5.0, 0.0, 0.0}, kSuction, motion);
  CHECK((floor.wrench.head<3>() - Eigen::Vector3d(0.0, 0.0, 2.0 * 0.25 * 16.0)).norm() < kPlacesRounding);
  motion.v_WF_B << 0.3, 0.4, 0.0;  // drifting with the water
  CHECK(load_of("bottom_effect", {2.0, 5.0, 0.0, 0.0}, kSuction, motion).wrench.isZero(kPlacesRounding));
  CHECK_FALSE(model::find_effect("bottom_effect")->possible(std::vector{-2.0, 5.0, 0.0, 0.0}, kSuction, {}));
}

TEST_CASE("wall_effect: pushes away from the wall, whatever the heading") {
  model::Motion motion;
  motion.p_WB = {1.0, 3.0, 0.0};
  // A wall in the east, 5 m from the origin: 2 m away.
  const std::vector<double> theta{8.0, 0.5 * std::numbers::pi, 5.0};
  motion.R_WB = rotation_from_euler({0.0, 0.0, 0.5 * std::numbers::pi});  // looking at it
  const model::Load load = load_of("wall_effect", theta, 0, motion);
  CHECK((load.wrench.head<3>() - Eigen::Vector3d(-2.0, 0.0, 0.0)).norm() < kPlacesRounding);
}

TEST_CASE(
    "bottom and wall: the exponential law has its strength at the place it is told for, and stays finite beyond") {
  constexpr int kForce = 2, kDrag = 3;
  constexpr double kReach = 0.5;  // m
  model::Motion motion;
  motion.p_WB = {0.0, 1.0, 2.0};
  const std::vector<double> floor{3.0, 0.0, kReach, 2.0};
  CHECK(load_of("bottom_effect", floor, kForce, motion).wrench.head<3>().isApprox(Eigen::Vector3d(0.0, 0.0, -3.0)));
  motion.p_WB.z() = 2.0 - kReach;
  CHECK(load_of("bottom_effect", floor, kForce, motion).wrench[2] == doctest::Approx(-3.0 / std::numbers::e));
  motion.nu << 0.6, 0.0, 0.8, 0.0, 0.0, 0.0;
  // Three times the hull's own at the place, which grows with it, and no moment.
  const model::Load drag = load_of("bottom_effect", floor, kDrag, motion);
  CHECK((drag.wrench.head<3>() + 3.0 / std::numbers::e * 4.0 * Eigen::Vector3d(0.6, 0.0, 0.8)).norm() <
        kPlacesRounding);
  CHECK(drag.wrench.tail<3>().isZero(0.0));
  CHECK(drag.drag_share == doctest::Approx(3.0 / std::numbers::e));
  motion.p_WB.z() = 1e3;
  CHECK(std::abs(load_of("bottom_effect", floor, kForce, motion).wrench[2]) < 100.0);

  const std::vector<double> wall{-2.0, 0.5 * std::numbers::pi, 0.0, kReach, 1.0 + kReach};  // sucks toward the east
  const model::Load load = load_of("wall_effect", wall, kForce, motion);
  CHECK((load.wrench.head<3>() - Eigen::Vector3d(0.0, 2.0 / std::numbers::e, 0.0)).norm() < kPlacesRounding);
}

TEST_CASE("tether_drag: proportional to the way to the fixed end, and to the square of speed") {
  model::Motion motion;
  motion.p_WB = {3.0, 4.0, 0.0};
  motion.nu[1] = 0.5;
  const model::Load load = load_of("tether_drag", {2.0, 0.0, 0.0, 0.0}, 0, motion);
  CHECK(load.wrench[1] == doctest::Approx(-2.0 * 5.0 * 0.25));
  CHECK(load_of("tether_drag", {2.0, 3.0, 4.0, 0.0}, 0, motion).wrench.isZero(0.0));
  motion.v_WF_B.y() = 0.5;  // drifting with the water
  CHECK(load_of("tether_drag", {2.0, 0.0, 0.0, 0.0}, 0, motion).wrench.isZero(0.0));
}

TEST_CASE("tether_drag: linear, proportional to the way to the fixed end and to speed") {
  constexpr int kLinear = 8;
  model::Motion motion;
  motion.p_WB = {3.0, 4.0, 0.0};
  motion.nu << 0.5, -0.1, 0.0, 0.2, 0.1, 0.4;
  const model::Load load = load_of("tether_drag", {2.0, 0.0, 0.0, 0.0, 0.7, 0.7, 0.7}, kLinear, motion);
  CHECK((load.wrench.head<3>() - Eigen::Vector3d(-5.0, 1.0, 0.0)).norm() < kPlacesRounding);
  CHECK(load.wrench.tail<3>().isZero(0.0));  // made fast at the origin
  const model::Effect& effect = *model::find_effect("tether_drag");
  CHECK(effect.numbers(kLinear) == effect.numbers(0));
  CHECK(effect.unit(kLinear, 0) == "N/(m/s)/m");
  CHECK(effect.unit(0, 0) == "N/(m/s)^2/m");
}

TEST_CASE("tether_drag: across its line only what goes across counts, whatever the heading") {
  constexpr int kAcross = 9;
  const std::vector<double> numbers{2.0, 0.0, 0.0, 0.0, 0.7, 0.7, 0.7};
  model::Motion motion;
  motion.p_WB = {3.0, 4.0, 0.0};
  for (const double heading : {0.0, 0.9, -2.0}) {
    CAPTURE(heading);
    motion.R_WB = rotation_from_euler({0.1, -0.2, heading});
    const Eigen::Vector3d along{0.6, 0.8, 0.0}, across{0.8, -0.6, 0.0};  // in W
    motion.nu.head<3>() = motion.R_WB.transpose() * (0.4 * along);
    CHECK(load_of("tether_drag", numbers, kAcross, motion).wrench.norm() < kPlacesRounding);
    motion.nu.head<3>() = motion.R_WB.transpose() * (0.4 * along + 0.5 * across);
    const model::Load load = load_of("tether_drag", numbers, kAcross, motion);
    CHECK((motion.R_WB * load.wrench.head<3>() + 2.0 * 5.0 * 0.25 * across).norm() < kPlacesRounding);
    CHECK(load.wrench.tail<3>().isZero(0.0));
  }
  motion.p_WB.setZero();  // at the fixed end there is no line
  CHECK(load_of("tether_drag", numbers, kAcross, motion).wrench.isZero(0.0));
  CHECK(model::find_effect("tether_drag")->numbers(kAcross) == model::find_effect("tether_drag")->numbers(0));
}

TEST_CASE("tethers made fast astern: the same pull as at that place of the hull, and its moment about the origin") {
  constexpr int kAstern = 7;
  const Eigen::Vector3d p_BC{-0.3, 0.05, -0.1};
  model::Motion motion, at_cleat;
  motion.p_WB = {3.0, 4.0, 1.0};
  motion.R_WB = rotation_from_euler({0.2, -0.1, 0.9});
  motion.nu << 0.4, -0.2, 0.1, 0.3, -0.2, 0.5;
  at_cleat = motion;
  at_cleat.p_WB += motion.R_WB * p_BC;
  at_cleat.nu.head<3>() += motion.nu.tail<3>().cross(p_BC);
  const std::vector<std::vector<double>> numbers{{1.5, 1.0, 0.5, -1.0, 0.0}, {2.0, 0.5, -1.0, 0.0}};
  const std::array names{"tether_tension", "tether_drag"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    CAPTURE(names[i]);
    const Eigen::Vector3d force = load_of(names[i], numbers[i], 0, at_cleat).wrench.head<3>();
    std::vector<double> astern = numbers[i];
    astern.insert(astern.end(), p_BC.begin(), p_BC.end());
    const model::Load load = load_of(names[i], astern, kAstern, motion);
    CHECK(force.norm() > 0.1);
    CHECK((load.wrench.head<3>() - force).norm() < kPlacesRounding);
    CHECK((load.wrench.tail<3>() - p_BC.cross(force)).norm() < kPlacesRounding);
    CHECK((load_of(names[i], astern, 0, motion).wrench - load_of(names[i], numbers[i], 0, motion).wrench).isZero(0.0));
  }
  // By hand: a pull to starboard at the stern turns the bow to port; drag that is towed astern resists turning.
  model::Motion level;
  CHECK(load_of("tether_tension", {2.0, 0.0, -0.5, 3.0, 0.0, -0.5, 0.0, 0.0}, kAstern, level).wrench[5] ==
        doctest::Approx(-0.5 * 2.0 * 3.0));
  level.nu[5] = 0.4;
  CHECK(load_of("tether_drag", {2.0, 5.0, 0.0, 0.0, -0.5, 0.0, 0.0}, kAstern, level).wrench[5] ==
        doctest::Approx(-0.5 * 2.0 * 5.5 * 0.2 * 0.2));
}

TEST_CASE("tethers made fast astern: asked for are the arms that turn the vehicle about a simulated axis") {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Scene scene = scene_in_a_tank(vehicle);
  scene.nu_rms.segment<2>(3).setZero();
  for (const char* name : {"tether_tension", "tether_drag"}) {
    const model::Effect& effect = *model::find_effect(name);
    const int at_origin = effect.numbers(0);
    vehicle.dof = {true, true, true, false, false, true};
    // The last form that is made fast elsewhere.
    const auto elsewhere = [&] {
      const std::vector<std::string> forms = effect.variants(scene);
      const auto last = std::find(forms.rbegin(), forms.rend(), "made fast off the origin");
      return static_cast<int>(forms.rend() - last) - 1;
    };
    CHECK(elsewhere() == 3);  // x and y
    CHECK(effect.variants(scene)[0].empty());
    CHECK(effect.numbers(3) == at_origin + 2);
    scene.nu_rms[4] = 0.3;  // pitch as measured moves a cable that drags
    CHECK(effect.numbers(elsewhere()) == at_origin + (effect.name() == "tether_drag" ? 3 : 2));
    scene.nu_rms.segment<2>(3).setZero();
    vehicle.dof.fill(true);
    CHECK(elsewhere() == 7);
    CHECK(effect.numbers(7) == at_origin + 3);
    CHECK(effect.starts(scene, 7).size() <= effect.starts(scene, 0).size());
    vehicle.dof = {true, true, true, false, false, false};
    CHECK(effect.variants(scene).front().empty());
    CHECK(elsewhere() == -1);
  }
}

TEST_CASE("effects of place: starts surround the water worked in, and nothing is asked without positions") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Scene scene = scene_in_a_tank(vehicle);
  for (const auto& start : model::find_effect("bottom_effect")->starts(scene, 0)) CHECK(start[1] > scene.p_high.z());
  for (const auto& start : model::find_effect("wall_effect")->starts(scene, 0)) {
    const Eigen::Vector3d n{std::cos(start[1]), std::sin(start[1]), 0.0};
    for (const double x : {-2.0, 2.0}) {
      for (const double y : {-1.0, 1.0}) CHECK(n.dot(Eigen::Vector3d(x, y, 0.0)) < start[2]);
    }
  }
  // The exponential law is told for the very edge of that water.
  for (const auto& start : model::find_effect("bottom_effect")->starts(scene, 2)) CHECK(start[3] == scene.p_high.z());
  for (const auto& start : model::find_effect("wall_effect")->starts(scene, 2)) {
    const Eigen::Vector2d n{std::cos(start[1]), std::sin(start[1])};
    CHECK(start[4] == doctest::Approx(n.cwiseAbs().dot(Eigen::Vector2d(2.0, 1.0))));
  }
  constexpr std::size_t kMost = 24;  // each start costs a rollout over all data
  for (const char* name : {"bottom_effect", "wall_effect", "tether_drag", "compressibility", "layered_water"}) {
    CHECK(model::find_effect(name)->starts(scene, 0).size() <= kMost);
    CHECK(model::find_effect(name)->feels_place());
    CHECK_FALSE(model::find_effect(name)->variants(scene).empty());
  }
  scene.position = false;
  for (const char* name : {"bottom_effect", "wall_effect", "tether_drag", "compressibility", "layered_water"}) {
    CHECK(model::find_effect(name)->variants(scene).empty());
  }
  scene.position = true;
  scene.p_high.z() = scene.p_low.z();  // constant depth
  CHECK(model::find_effect("compressibility")->variants(scene).empty());
  CHECK(model::find_effect("bottom_effect")->variants(scene).empty());
}

TEST_CASE("tether_tension: so far away that its pull neither turns nor grows, it is any steady force of the world") {
  const model::Effect& tether = *model::find_effect("tether_tension");
  model::Scene scene;
  scene.p_low = {-2.0, -1.0, 0.0};
  scene.p_high = {2.0, 1.0, 1.5};
  const auto other = [&](double slack, double distance) {
    return tether.looks_like(std::vector{0.5, slack, distance, 0.0, 0.7, 0.0, 0.0, 0.0}, 0, scene).what;
  };
  CHECK(other(0.0, 3e4) == "a steady force in one direction of the world");
  CHECK(other(20.0, 60.0) == "a steady force in one direction of the world");
  CHECK(other(3.0, 6.0).empty());    // it turns, and grows from nothing
  CHECK(other(58.0, 60.0).empty());  // it grows
  // In the outermost places its pull differs from a steady one by less than a tenth of itself.
  model::Motion here, there;
  there.p_WB = scene.p_high;
  const std::vector<double> far{0.5, 20.0, 60.0, 0.0, 0.7, 0.0, 0.0, 0.0};
  const Vector6d middle = load_of("tether_tension", far, 0, here).wrench;
  CHECK((load_of("tether_tension", far, 0, there).wrench - middle).norm() < 0.1 * middle.norm());
}
