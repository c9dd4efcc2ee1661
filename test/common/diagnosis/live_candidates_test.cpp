// What candidates would add to the wrench, against the effects themselves.
#include "common/diagnosis/live_candidates.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "test/support/virtual_dive.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kRounding = 1e-9;   // N: differences of wrenches of some N, over steps of a thousandth
constexpr double kCurvature = 5e-3;  // of a column: differences over a thousandth of the number

model::Scene scene_of(const model::Vehicle& vehicle) {
  model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.voltage = true;
  scene.duration = 100.0;
  scene.mean_voltage = 15.0;
  scene.voltage_range = 2.0;
  scene.p_low.setConstant(-1.0);
  scene.p_high.setConstant(1.0);
  scene.nu_rms.setConstant(0.3);
  scene.tau_rms.setConstant(5.0);
  scene.force_rms = model::ActuatorForces::Constant(static_cast<Eigen::Index>(vehicle.thrusters.size()), 3.0);
  return scene;
}

/// A vehicle under way, its candidates, and their columns at one instant.
struct Instant {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  model::Model base = model::nominal_model(vehicle, false);
  LiveCandidates candidates{base, scene_of(vehicle)};
  model::Motion motion;
  WrenchColumns wrench = WrenchColumns::Zero(6, candidates.columns() + LiveCandidates::kTurns);
  WrenchColumns momentum = WrenchColumns::Zero(6, static_cast<Eigen::Index>(candidates.inertial().size()));

  Instant() {
    motion.p_WB << 0.4, -0.7, 0.2;  // well above the bottom, whose effect is too steep for differences close to it
    motion.R_WB = rotation_from_euler({0.05, -0.1, 0.8});
    motion.nu << 0.4, -0.2, 0.15, 0.1, -0.1, 0.3;
    motion.force = model::ActuatorForces::LinSpaced(base.allocation.cols(), -4.0, 6.0);
    motion.voltage = 13.0;
    motion.vehicle = &vehicle;
  }
  void step() { candidates.step(motion, motion.force, 0.1, wrench, momentum); }
  [[nodiscard]] const LiveForm& form(const LiveStart& start) const {
    return candidates.forms()[static_cast<std::size_t>(start.form)];
  }
  /// The first start of an effect's variant.
  [[nodiscard]] const LiveStart& start(const std::string& name, int variant = 0) const {
    const auto& all = candidates.starts();
    const auto found = std::find_if(all.begin(), all.end(), [&](const LiveStart& one) {
      return form(one).effect->name() == name && form(one).variant == variant;
    });
    REQUIRE(found != all.end());
    return *found;
  }
  /// Wrench that an effect without memory adds, directly.
  [[nodiscard]] Vector6d added(const LiveForm& form, const std::vector<double>& theta) const {
    model::Load load;
    const Vector6d without = model::generalised_force(base, motion, load);
    model::Motion felt = motion;
    form.effect->feel(felt, theta, form.variant, {});
    const Vector6d force = model::generalised_force(base, felt, load);
    form.effect->load(felt, theta, form.variant, load);
    return force + load.wrench - without;
  }
};

}  // namespace

TEST_CASE("live candidates: every form of every effect that the scene admits has its starts, columns in a row") {
  const Instant instant;
  const LiveCandidates& candidates = instant.candidates;
  Eigen::Index next = 0;
  for (const LiveStart& start : candidates.starts()) {
    CHECK(start.column == next);
    CHECK(start.theta.size() == instant.form(start).effect->parameters().size());
    next += start.columns();
  }
  CHECK(next == candidates.columns());
  for (const model::Effect* effect : model::all_effects()) {
    const auto names = effect->variants(scene_of(instant.vehicle));
    const auto admitted = std::count_if(names.begin(), names.end(), [](const auto& name) { return name != "-"; });
    const auto asked = std::count_if(candidates.forms().begin(), candidates.forms().end(),
                                     [&](const LiveForm& form) { return form.effect == effect; });
    CAPTURE(effect->name());
    // One that only measures adds no wrench; but an arm alters what velocities say of forces.
    CHECK(asked == (effect->name() == "lever_arm" ? 1 : effect->measures() ? 0 : admitted));
  }
  // Where inputs are the six axes of a wrench, no single thruster can be asked.
  model::Scene wrench = scene_of(instant.vehicle);
  wrench.input_is_wrench = true;
  const LiveCandidates fewer{model::nominal_model(instant.vehicle, true), wrench};
  for (const LiveForm& form : fewer.forms()) CHECK(form.effect->name() != "thruster_gain");
}

TEST_CASE("live candidates: a thruster's gain adds its own thrust, in newtons by hand") {
  Instant instant;
  instant.step();
  for (int k = 0; k < 6; ++k) {
    const LiveStart& start = instant.start("thruster_gain", k);
    const double sigma = instant.form(start).effect->parameters()[0].sigma;
    const Vector6d thrust = instant.base.allocation.col(k) * instant.motion.force[k];
    CHECK((instant.wrench.col(start.column) - start.theta[0] * thrust).norm() < kRounding);
    CHECK((instant.wrench.col(start.column + 1) - sigma * thrust).norm() < kRounding);
  }
}

TEST_CASE("live candidates: columns are the effect at its start and its change per sigma of each number") {
  Instant instant;
  instant.step();
  int compared = 0;
  for (const LiveStart& start : instant.candidates.starts()) {
    const LiveForm& form = instant.form(start);
    if (form.effect->state_size(instant.vehicle, 6) > 0 || form.effect->name() == "thruster_delay") continue;
    if (form.effect->measures()) continue;  // below
    CAPTURE(form.effect->name());
    CAPTURE(form.variant_name);
    const Vector6d at_start = instant.added(form, start.theta);
    CHECK((instant.wrench.col(start.column) - at_start).norm() < kRounding);
    CHECK(start.columns() == 1 + form.effect->numbers(form.variant));
    for (std::size_t c = 0; c < form.sought.size(); ++c) {
      const std::size_t i = form.sought[c];
      const model::EffectParameter& parameter = form.effect->parameters()[i];
      std::vector<double> moved = start.theta;
      const double step = 1e-5 * std::max(std::abs(start.theta[i]), 0.1 * parameter.sigma);
      moved[i] += start.theta[i] + step > parameter.high ? -step : step;
      const Vector6d slope = (instant.added(form, moved) - at_start) / (moved[i] - start.theta[i]) * parameter.sigma;
      const Vector6d column = instant.wrench.col(start.column + 1 + static_cast<Eigen::Index>(c));
      CAPTURE(parameter.name);
      CHECK((column - slope).norm() < kCurvature * (slope.norm() + at_start.norm()) + 1e-6);
      ++compared;
    }
  }
  CHECK(compared > 20);
}

TEST_CASE("live candidates: with a lever arm the hull moved otherwise, which is drag and momentum") {
  Instant instant;
  instant.step();
  const LiveStart& start = instant.start("lever_arm");
  const Eigen::Vector3d arm{start.theta[0], start.theta[1], start.theta[2]};
  model::Motion moved = instant.motion;  // as it moved in truth: what was measured, without w x r
  moved.nu.head<3>() -= moved.nu.tail<3>().cross(arm);
  model::Load load;
  const Vector6d drag = model::generalised_force(instant.base, moved, load) -
                        model::generalised_force(instant.base, instant.motion, load);
  CHECK((instant.wrench.col(start.column) - drag).norm() < kRounding);
  const auto& inertial = instant.candidates.inertial();
  const auto entry = std::ranges::find(inertial, start.column) - inertial.begin();
  REQUIRE(entry < static_cast<std::ptrdiff_t>(inertial.size()));
  Vector6d momentum = instant.base.theta.head<6>().cwiseProduct(moved.nu - instant.motion.nu);
  CHECK((instant.momentum.col(entry) - momentum).norm() < kRounding);
  const Eigen::Vector3d per_metre = -moved.nu.tail<3>().cross(Eigen::Vector3d::UnitX());
  momentum << instant.base.theta.head<3>().cwiseProduct(per_metre), Eigen::Vector3d::Zero();
  const double sigma = instant.form(start).parameters[0].sigma;
  CHECK((instant.momentum.col(entry + 1) - sigma * momentum).norm() < 1e-6);
}

TEST_CASE("live candidates: axes of a gyro that are turned show as the drag and the momentum of other rates") {
  constexpr double kTurn = 1e-4;  // rad, a tenth of what differences are taken over
  Instant instant;
  instant.step();
  model::Load load;
  for (Eigen::Index k = 0; k < LiveCandidates::kTurns; ++k) {
    model::Motion turned = instant.motion;
    turned.nu.tail<3>() -= kTurn * Eigen::Vector3d::Unit(k).cross(instant.motion.nu.tail<3>());
    const Vector6d drag = model::generalised_force(instant.base, turned, load) -
                          model::generalised_force(instant.base, instant.motion, load);
    const Vector6d column = instant.wrench.col(instant.candidates.columns() + k);
    CHECK(column.norm() > 0.0);
    CHECK((column - drag / kTurn).norm() < kCurvature * column.norm());
    const Vector6d momentum = instant.base.theta.head<6>().cwiseProduct(turned.nu - instant.motion.nu) / kTurn;
    CHECK((instant.momentum.rightCols(LiveCandidates::kTurns).col(k) - momentum).norm() < 1e-6);
  }
}

TEST_CASE("live candidates: memory is at rest after a reset and follows the command afterwards") {
  Instant instant;
  const LiveStart& lag = instant.start("thruster_lag");
  instant.step();
  CHECK(instant.wrench.col(lag.column).norm() < kRounding);  // the thrust has long been what it is
  const model::ActuatorForces before = instant.motion.force;
  instant.motion.force *= 2.0;
  instant.step();
  const Vector6d lacking = instant.wrench.col(lag.column);
  const Vector6d jump = instant.base.allocation * before;
  CHECK(lacking.dot(jump) < 0.0);  // it has not reached the new thrust
  CHECK(lacking.norm() < jump.norm());
  instant.step();
  CHECK(instant.wrench.col(lag.column).norm() < lacking.norm());  // and comes nearer
  instant.candidates.reset();
  instant.step();
  CHECK(instant.wrench.col(lag.column).norm() < kRounding);
}

TEST_CASE("live candidates: inertia enters as momentum") {
  Instant instant;
  REQUIRE_FALSE(instant.candidates.inertial().empty());
  instant.step();
  for (std::size_t i = 0; i < instant.candidates.inertial().size(); ++i) {
    const Eigen::Index column = instant.candidates.inertial()[i];
    if (column >= instant.candidates.columns()) continue;  // turns
    const auto& starts = instant.candidates.starts();
    const auto start = std::find_if(starts.begin(), starts.end(), [&](const LiveStart& one) {
      return column >= one.column && column < one.column + one.columns();
    });
    REQUIRE(start != starts.end());
    const LiveForm& form = instant.form(*start);
    if (form.effect->measures()) continue;  // below
    CAPTURE(form.variant_name);
    const bool centre = form.effect->name() == "centre_of_mass";
    CHECK((centre || form.variant_name.find("_dot") != std::string::npos));
    if (centre && column != start->column) continue;  // not linear: its numbers square in the moments of inertia
    model::Load load;
    form.effect->load(instant.motion, start->theta, form.variant, load);
    // Linear in its one number: the start's momentum, and that of one sigma.
    const double share = column == start->column ? 1.0 : form.effect->parameters()[0].sigma / start->theta[0];
    const Vector6d expected = share * load.inertia() * instant.motion.nu;
    CHECK((instant.momentum.col(static_cast<Eigen::Index>(i)) - expected).norm() < kRounding);
  }
}

}  // namespace fathom::diagnosis
