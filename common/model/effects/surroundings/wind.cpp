// Physics: steady wind on what stands above the water: w = 1/2 rho_a A_w [C_X |v_a| v_a,x; C_Y |v_a| v_a,y; 0], v_a the
// wind past the craft, v_a = R_WB^T (W_N, W_E, 0) - v (Fossen 2011, sec. 8.1, with coefficients that go as cosine and
// sine of the angle; Blendermann 1994 for their size), and the yaw moment N = arm Y. A_w is the vehicle file's
// `windage`. Wind speed and direction are numbers to be found; C_X = 0.6 and C_Y = 0.9 are typical and fixed, since the
// square of the wind takes up what they are wrong by. Ignores: gusts, and the hull's own shelter. Revealed by the same
// motion on several headings, at rest and at speed. Confused with current (which acts below) and steady_force (which
// the wind is, while the craft is slow beside it).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kWindParameters{
    EffectParameter{.name = "W_N", .unit = "m/s", .sigma = 5.0, .low = -40.0, .high = 40.0},
    EffectParameter{.name = "W_E", .unit = "m/s", .sigma = 5.0, .low = -40.0, .high = 40.0},
    EffectParameter{.name = "arm", .unit = "m", .sigma = 0.3, .low = -50.0, .high = 50.0}};
constexpr std::size_t kArm = 2;
constexpr double kAirDensity = 1.23;                     // kg/m^3
constexpr double kAhead = 0.6, kAcross = 0.9;            // coefficients of small craft (Blendermann 1994)
constexpr std::array kWindBearings{0.0, 0.5, 1.0, 1.5};  // of pi, where a search begins
constexpr double kBreeze = 3.0;                          // m/s

class OnWhatStandsOut final : public Form {
 public:
  FormName name(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    return when(scene.vehicle->windage > 0.0 && scene.attitude && scene.velocity && (dof[0] || dof[1]));
  }
  Starts starts(const Scene&) const override {
    Starts starts;
    for (const double bearing : kWindBearings)
      starts.push_back(
          {kBreeze * std::cos(bearing * std::numbers::pi), kBreeze * std::sin(bearing * std::numbers::pi), 0.0});
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[0] == 0.0 && theta[1] == 0.0) return;  // no wind, and drag in still air belongs to the hull's
    const Eigen::Vector3d wind_B = motion.R_WB.transpose() * Eigen::Vector3d(theta[0], theta[1], 0.0);
    const Eigen::Vector2d v = motion.nu.head<2>(), past = wind_B.head<2>() - v;
    const double pressure = 0.5 * kAirDensity * motion.vehicle->windage;
    // What still air would do is taken off: it is part of the hull's own drag.
    const Eigen::Vector2d push = pressure * (past.norm() * past + v.norm() * v);
    load.wrench[0] += kAhead * push.x();
    load.wrench[1] += kAcross * push.y();
    load.wrench[5] += theta[kArm] * kAcross * push.y();
  }
};

}  // namespace

const Effect& wind() {
  static const Effect kEffect{{.name = "wind",
                               .sentence = "Wind pushes on what stands above the water.",
                               .revealed_by = "the same motion on several headings, at rest and at full speed",
                               .stage = Stage::kBody,
                               .feels_motion = false},
                              kWindParameters,
                              forms(OnWhatStandsOut{})};
  return kEffect;
}

}  // namespace fathom::model::effects
