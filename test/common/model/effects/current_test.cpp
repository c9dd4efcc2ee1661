// The forms of current: what the water does at a depth and at a time.
#include <doctest/doctest.h>

#include <algorithm>

#include "common/model/dynamics.hpp"
#include "common/model/effect_size.hpp"
#include "common/model/onset.hpp"
#include "common/model/open_scene.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kRounding = 1e-12;
constexpr int kByDepth = 1, kTurning = 2, kChanging = 3;

/// The water's velocity in W.
Eigen::Vector3d water(const model::ActiveEffect& active, double t, double depth) {
  model::Motion motion{.t = t, .p_WB = {1.0, 2.0, depth}, .force = model::ActuatorForces::Zero(6)};
  motion.R_WB = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  active.effect->feel(motion, active.theta, active.variant, {});
  return motion.R_WB * motion.v_WF_B;
}

/// The form with these numbers, by name; the others are zero.
model::ActiveEffect form(int variant, const std::vector<std::pair<std::string_view, double>>& numbers) {
  model::ActiveEffect active = test::active("current", {}, variant);
  const auto parameters = active.effect->parameters();
  for (const auto& [name, value] : numbers) {
    const auto found = std::ranges::find(parameters, name, &model::EffectParameter::name);
    REQUIRE(found != parameters.end());
    active.theta[static_cast<std::size_t>(found - parameters.begin())] = value;
  }
  return active;
}

void agree(const Eigen::Vector3d& a, double north, double east) {
  CHECK((a - Eigen::Vector3d(north, east, 0.0)).norm() < kRounding);
}

}  // namespace

TEST_CASE("current: by depth it grows along a line from the depth at which it is stated") {
  const model::ActiveEffect shear =
      form(kByDepth, {{"v_N", 0.1}, {"v_E", -0.2}, {"shear_N", 0.05}, {"shear_E", 0.1}, {"at_depth", 3.0}});
  agree(water(shear, 0.0, 3.0), 0.1, -0.2);
  agree(water(shear, 50.0, 5.0), 0.2, 0.0);
}

TEST_CASE("current: a turn takes its time about its moment, half of it before") {
  const model::ActiveEffect turn = form(
      kTurning, {{"v_N", 0.1}, {"v_E", 0.0}, {"v_N_2", -0.1}, {"v_E_2", 0.3}, {"onset", 100.0}, {"duration", 40.0}});
  agree(water(turn, 79.0, 1.0), 0.1, 0.0);
  agree(water(turn, 100.0, 1.0), 0.0, 0.15);
  agree(water(turn, 121.0, 9.0), -0.1, 0.3);
}

TEST_CASE("current: what changes goes along straight lines between seven moments, and stays beyond them") {
  const model::ActiveEffect changing =
      form(kChanging, {{"from", 10.0}, {"until", 130.0}, {"v_N", 0.1}, {"v_N_2", 0.3}, {"v_E_7", 0.2}});
  agree(water(changing, 0.0, 1.0), 0.1, 0.0);
  agree(water(changing, 20.0, 1.0), 0.2, 0.0);
  agree(water(changing, 30.0, 1.0), 0.3, 0.0);
  agree(water(changing, 120.0, 1.0), 0.0, 0.1);
  agree(water(changing, 900.0, 1.0), 0.0, 0.2);
}

TEST_CASE("current: a stream may set in at once: what is quicker than any data tells is no limit that was met") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  model::ActiveEffect turn = form(kTurning, {{"v_N_2", 0.2}, {"onset", 100.0}, {"duration", model::kOnsetDuration}});
  CHECK_FALSE(model::stopped_at_limit(*turn.effect, kTurning, turn.theta, vehicle));
  turn = form(kTurning, {{"v_N_2", 3.0}, {"onset", 100.0}, {"duration", 1.0}});
  CHECK(model::stopped_at_limit(*turn.effect, kTurning, turn.theta, vehicle));
}

TEST_CASE("current: moments are asked of one run alone, depths where they were visited") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const model::Effect& current = *model::find_effect("current");
  model::Scene scene = model::open_scene(vehicle, false);
  CHECK(current.variants(scene) == std::vector<std::string>{"", "by depth", "turning", "changing"});
  scene.runs = 2;
  CHECK(current.variants(scene) == std::vector<std::string>{"", "by depth", "-", "-"});
  scene.p_high = scene.p_low;
  CHECK(current.variants(scene) == std::vector<std::string>{"", "-", "-", "-"});
}

TEST_CASE("current: a fit seeks the numbers of its form, and no others") {
  const model::Effect& current = *model::find_effect("current");
  CHECK(current.sought(0) == std::vector<std::size_t>{0, 1});
  CHECK(current.numbers(kByDepth) == 4);
  CHECK(current.numbers(kTurning) == 6);
  CHECK(current.numbers(kChanging) == 14);
  CHECK(current.form_count() == 4);
  CHECK(current.rules_out(0, kChanging));
}
