// Physics: the velocity sensor sits away from the body's origin, so it also measures the speed of turning there:
// v_measured = v + w x r (rigid body; Fossen 2011, eq. 2.26), r from Bo to the sensor in B. Nothing about the vehicle
// changes. Ignores: an arm that differs between sensors, misalignment of the sensor's axes. Revealed by turning on the
// spot about every axis. Confused with cross_coupling of sway and yaw (a shift of the origin looks like off-diagonal
// inertia and drag), thruster_misalignment.
#include <array>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kLeverArmParameters{EffectParameter{"r_x", "m", 0.2, -20.0, 20.0},
                                         EffectParameter{"r_y", "m", 0.2, -20.0, 20.0},
                                         EffectParameter{"r_z", "m", 0.2, -20.0, 20.0}};
constexpr double kSmallestTurning = 0.01;  // rad/s

void shift(VelocityView& nu, const Eigen::Vector3d& r) {
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    const Eigen::Vector3d w = nu.col(k).tail<3>();
    nu.col(k).head<3>() += w.cross(r);
  }
}

class SensorAway final : public Form {
 public:
  FormName name(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    return when(scene.velocity && !scene.velocity_checked() && (dof[0] || dof[1] || dof[2]) &&
                scene.nu_rms.tail<3>().norm() > kSmallestTurning);
  }
  Starts starts(const Scene&) const override { return {{0.05, 0.05, 0.05}}; }
  void measure(VelocityView& nu, double, EffectTheta theta) const override {
    shift(nu, {theta[0], theta[1], theta[2]});
  }
  void unmeasure(VelocityView& nu, double, EffectTheta theta) const override {
    shift(nu, {-theta[0], -theta[1], -theta[2]});
  }
};

}  // namespace

const Effect& lever_arm() {
  static const Effect kEffect{{.name = "lever_arm",
                               .sentence = "The velocity sensor sits away from the origin and feels the turning.",
                               .revealed_by = "turning on the spot about every axis",
                               .stage = Stage::kSensor,
                               .feels_motion = false,
                               .asked_first = true},
                              kLeverArmParameters,
                              forms(SensorAway{})};
  return kEffect;
}

}  // namespace fathom::model::effects
