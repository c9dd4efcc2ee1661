// Why an effect is not asked for: by every effect of the registry, and by those whose reason is known beforehand.
#include "common/preflight/applicability.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::preflight;

namespace {

/// A planar or whole vehicle without thrusters in a run that shows everything.
struct MadeUp {
  model::Vehicle vehicle;
  model::Scene scene;

  MadeUp() {
    vehicle.dof.fill(true);
    scene.position = scene.attitude = scene.velocity = scene.rates = true;
    scene.input_is_wrench = true;
    scene.t_high = scene.duration = 300.0;
    scene.p_low.setConstant(-3.0);
    scene.p_high.setConstant(3.0);
    scene.nu_rms.setOnes();
    scene.tau_rms.setOnes();
    scene.force_rms = model::ActuatorForces::Ones(6);
    scene.tilt_rms = 0.2;
    scene.tones_horizontal = scene.tones_vertical = {{.omega = 1.0}};
  }
  [[nodiscard]] std::string why(const std::string& name) {
    scene.vehicle = &vehicle;
    return why_not_asked(*model::find_effect(name), scene);
  }
  [[nodiscard]] std::vector<std::string> barred_without(const std::string& group) {
    scene.vehicle = &vehicle;
    for (const NotMeasured& one : not_measured(scene)) {
      if (one.group == group) return one.cannot_be_asked;
    }
    return {"not listed"};
  }
};

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

TEST_CASE("applicability: what the data lacks, what the base model has, what the vehicle cannot do") {
  MadeUp made;
  CHECK(made.why("thruster_gain") == "not applicable: needs forces of single thrusters");
  CHECK(made.why("centre_of_mass") == "not applicable: the vehicle file does not state the mass");
  CHECK(made.why("sensor_scale") == "not applicable: sensors are compared with each other");
  CHECK(made.why("lever_arm") == "not applicable: sensors are compared with each other");
  made.scene.position = made.scene.attitude = made.scene.rates = false;  // nothing to compare with
  made.scene.nu_rms.tail<3>().setZero();
  CHECK(made.why("lever_arm") == "not applicable: not measured: rates");
  made.scene.position = made.scene.attitude = made.scene.rates = true;
  made.vehicle.parameters = {"G_x", "G_y", "G_z"};
  CHECK(made.why("restoring_moment") == "not applicable: the base model has it");
  made.scene.p_high.z() = made.scene.p_low.z();
  CHECK(made.why("compressibility") == "not applicable: nothing in these runs could show it");
  made.vehicle.dof[2] = false;
  CHECK(made.why("compressibility") == "not applicable: acts along no simulated axis");
  made.scene.attitude = false;
  CHECK(made.why("current") == "not applicable: not measured: attitude");
  made.scene.velocity = false;
  CHECK(made.why("current") == "not applicable: not measured: attitude, velocity");
}

TEST_CASE("applicability: effects without a form in a scene have exactly one reason, and groups bar what needs them") {
  MadeUp made;
  CHECK(made.barred_without("attitude") == std::vector<std::string>{"not listed"});
  made.scene.position = false;
  made.scene.p_low = made.scene.p_high;
  CHECK(holds(made.barred_without("position"), "tether_tension"));
  CHECK_FALSE(holds(made.barred_without("position"), "current"));
  CHECK_FALSE(holds(made.barred_without("position"), "thruster_lag"));
  made.scene.attitude = false;
  CHECK(holds(made.barred_without("position"), "tether_tension"));
  CHECK(holds(made.barred_without("attitude"), "current"));
  for (const model::Effect* effect : model::all_effects()) {
    CAPTURE(effect->name());
    CHECK(made.why(std::string(effect->name())).rfind("not applicable: ", 0) == 0);
  }
}

TEST_CASE("applicability: a sentence per missing group that the vehicle's axes or an effect need") {
  model::Vehicle vehicle;
  vehicle.dof = {false, false, false, true, true, true};
  CHECK(not_measured_sentences({{"velocity", {}}, {"position", {}}}, vehicle).empty());
  CHECK(not_measured_sentences({{"attitude", {"current", "wave"}}}, vehicle) ==
        "Attitude was not measured: current, wave could not be asked, and what tilts the vehicle is not known. ");
  vehicle.dof = {true, true, false, false, false, false};
  CHECK(not_measured_sentences({{"rates", {}}}, vehicle).empty());
  vehicle.dof[5] = true;
  CHECK(not_measured_sentences({{"rates", {}}}, vehicle) ==
        "Rates were not measured: only what moves the vehicle along was explained. ");
}
