// What every effect of the registry owes the house, without its author writing a test.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/model/dynamics.hpp"
#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kAbsent = 1e-12;  // relative: battery_sag multiplies by pow(x, 0)

/// Six axes, eight thrusters, two of them one behind the other, one component of the restoring moment that the base
/// model does not have, and something that stands above the water.
model::Vehicle vehicle_without_G_y() {
  model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  vehicle.windage = 0.2;
  vehicle.thrusters[1].p_BJ = vehicle.thrusters[0].p_BJ + 0.3 * vehicle.thrusters[0].axis_B;
  const auto place = std::find(vehicle.parameters.begin(), vehicle.parameters.end(), "G_y");
  vehicle.priors.erase(vehicle.priors.begin() + (place - vehicle.parameters.begin()));
  vehicle.parameters.erase(place);
  return vehicle;
}

struct Fixture {
  model::Vehicle vehicle = vehicle_without_G_y();
  model::Vehicle open_frame = test::vehicle_from_repository("beluga");  ///< it does not live by its flow
  test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 30.0, .seed = 4, .velocity_noise = 0.0, .rate_noise = 0.0});
  model::Scene scene = model::scene_of(vehicle, {&dive.trial, 1});

  /// Accelerations along the dive with one effect, or none; for one that only measures, what it says of the dive.
  [[nodiscard]] std::vector<Vector6d> accelerations(const model::ActiveEffect* effect) const {
    model::Model model = dive.truth;
    if (effect != nullptr) model.add(*effect);
    std::vector<double> memory(static_cast<std::size_t>(model.memory_size()), 0.0);
    const Trial& trial = dive.trial;
    const model::InputSignal input{0.0, trial.dt, trial.input};
    std::vector<Vector6d> all;
    model::VelocityTrace seen(6, static_cast<Eigen::Index>(trial.size()));
    for (std::size_t k = 0; k < trial.size(); ++k) {
      model::Motion motion{
          .t = trial.t[k], .p_WB = trial.p_WB[k], .R_WB = trial.q_WB[k].toRotationMatrix(), .nu = trial.nu[k]};
      input.at(motion.t, motion.force);
      motion.voltage = trial.voltage[k];
      motion.input = &input;
      motion.vehicle = &vehicle;
      if (k == 0) model::settle(model, motion, memory);
      model::feel(model, motion, memory, k == 0 ? 0.0 : trial.dt);
      all.push_back(model::acceleration(model, motion));
      seen.col(static_cast<Eigen::Index>(k)) = trial.nu[k];
    }
    model::VelocityView view{seen};
    if (effect != nullptr) effect->effect->measure(view, trial.dt, effect->theta, effect->variant);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += seen.col(static_cast<Eigen::Index>(k));
    return all;
  }
};

template <class Check>
void for_every_form(const Fixture& fixture, Check check) {
  for (const model::Effect* effect : model::all_effects()) {
    model::Scene scene = fixture.scene;
    if (effect->measures())
      scene.position = scene.attitude = false;  // nothing that could check the sensor by kinematics
    if (effect->variants(scene).empty()) scene.vehicle = &fixture.open_frame;
    const auto names = effect->variants(scene);
    CHECK_MESSAGE(!names.empty(), std::string{effect->name()} << " must be able to act on a full six-axis dive");
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (names[v] != "-") check(*effect, static_cast<int>(v), names[v]);
    }
  }
}

}  // namespace

TEST_CASE("every effect: with all numbers zero nothing changes") {
  const Fixture fixture;
  const auto nominal = fixture.accelerations(nullptr);
  for_every_form(fixture, [&](const model::Effect& effect, int variant, const std::string& name) {
    const model::ActiveEffect absent{&effect, variant, name, std::vector<double>(effect.parameters().size(), 0.0)};
    const auto with = fixture.accelerations(&absent);
    double worst = 0.0;
    for (std::size_t k = 0; k < with.size(); ++k)
      worst = std::max(worst, (with[k] - nominal[k]).norm() / (1.0 + nominal[k].norm()));
    CAPTURE(effect.name());
    CAPTURE(name);
    CHECK(worst < kAbsent);
  });
}

TEST_CASE("every effect: from each start something changes, and everything is finite") {
  const Fixture fixture;
  const auto nominal = fixture.accelerations(nullptr);
  for_every_form(fixture, [&](const model::Effect& effect, int variant, const std::string& name) {
    const auto starts = effect.starts(fixture.scene, variant);
    CAPTURE(effect.name());
    CAPTURE(name);
    CHECK_FALSE(starts.empty());
    for (const auto& theta : starts) {
      REQUIRE(theta.size() == effect.parameters().size());
      const model::ActiveEffect present{&effect, variant, name, theta};
      const auto with = fixture.accelerations(&present);
      double largest = 0.0;
      bool finite = true;
      for (std::size_t k = 0; k < with.size(); ++k) {
        finite = finite && with[k].allFinite();
        largest = std::max(largest, (with[k] - nominal[k]).norm());
      }
      CHECK(finite);
      CHECK(largest > 1e-6);
    }
  });
}

TEST_CASE("every effect: extreme numbers within the bounds stay finite") {
  const Fixture fixture;
  for_every_form(fixture, [&](const model::Effect& effect, int variant, const std::string& name) {
    for (const double side : {-1.0, 1.0}) {
      model::ActiveEffect extreme{&effect, variant, name, {}};
      for (const auto& p : effect.parameters()) {
        extreme.theta.push_back(std::clamp(side * 10.0 * p.sigma, p.low, p.high));
      }
      CAPTURE(effect.name());
      const auto with = fixture.accelerations(&extreme);
      CHECK(std::all_of(with.begin(), with.end(), [](const Vector6d& a) { return a.allFinite(); }));
    }
  });
}

TEST_CASE("every effect: names, words, units and priors are stated") {
  std::set<std::string_view> names;
  for (const model::Effect* effect : model::all_effects()) {
    CAPTURE(effect->name());
    CHECK(names.insert(effect->name()).second);
    CHECK(model::find_effect(effect->name()) == effect);
    CHECK(effect->sentence().ends_with("."));
    CHECK_FALSE(effect->revealed_by().empty());
    for (std::string_view rest = effect->traits().finding; rest.find('{') != std::string_view::npos;) {
      rest.remove_prefix(rest.find('{') + 1);
      const std::string_view name = rest.substr(0, rest.find_first_of(" }"));
      CAPTURE(name);
      // A comparison of sensors tells of a delay.
      const bool other = name == "form" || name == "thruster" || (effect->measures() && name == "delay");
      CHECK((other ||
             std::ranges::any_of(effect->parameters(), [&](const auto& parameter) { return parameter.name == name; })));
    }
    REQUIRE_FALSE(effect->parameters().empty());
    // Some number must be able to say "absent".
    CHECK(std::any_of(effect->parameters().begin(), effect->parameters().end(),
                      [](const auto& parameter) { return parameter.low <= 0.0; }));
    for (const auto& parameter : effect->parameters()) {
      CHECK_FALSE(parameter.name.empty());
      CHECK(parameter.sigma > 0.0);
      CHECK(std::isfinite(parameter.sigma));
      CHECK(parameter.low < parameter.high);
      CHECK(parameter.high > 0.0);
    }
  }
  CHECK(model::find_effect("kraken") == nullptr);
}

TEST_CASE("every effect: one file, one line, one name") {
  const std::filesystem::path folder = std::string{FATHOM_SOURCE_DIR} + "/common/model/effects";
  std::set<std::string> files, lines, registered;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder}) {
    if (entry.path().extension() == ".cpp") CHECK(files.insert(entry.path().stem().string()).second);
  }
  std::ifstream text{folder / "effects.def"};
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("EFFECT(")) lines.insert(line.substr(7, line.find(')') - 7));
  }
  for (const model::Effect* effect : model::all_effects()) registered.insert(std::string{effect->name()});
  CHECK(files == lines);
  CHECK(lines == registered);
}

TEST_CASE("every effect: what only drags or pulls toward rest adds no power") {
  const Fixture fixture;
  // A lag or a delay changes when power comes; these change how much the water takes.
  model::Motion motion;
  motion.vehicle = &fixture.vehicle;
  motion.force = model::ActuatorForces::Zero(8);
  for (const auto& nu : fixture.dive.trial.nu) {
    motion.nu = nu;
    model::Load load;
    model::find_effect("thruster_deadband")->load(motion, std::vector{1.0}, 0, load);
    model::find_effect("tether_tension")->load(motion, std::vector{5.0, 0.0, 0.0, 0.0, 0.0}, 0, load);
    CHECK(load.wrench.isZero(0.0));  // anchored where it is, nothing pulls
  }
}
