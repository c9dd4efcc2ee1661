// Physics: steady wind on what stands above the water: w = 1/2 rho_a A_w [C_X |v_a| v_a,x; C_Y |v_a| v_a,y; 0], v_a the
// wind past the craft, v_a = R_WB^T (W_N, W_E, 0) - v (Fossen 2011, sec. 8.1, with coefficients that go as cosine and
// sine of the angle; Blendermann 1994 for their size), and the yaw moment N = (arm + shift v_a,x / |v_a|) Y. A_w is the
// vehicle file's `windage`, the side view, or half of a boat's hull side where it states none. Two laws, of which a
// craft has one: what stands out is as large from ahead as from the side (a mast, a cabin), and shift is none; or it is
// the hull's side, from ahead as much smaller as the hull is narrower than long, and the pressure's centre moves toward
// the end that is blown on (Isherwood 1973: N goes with the sine of twice the angle). Wind speed and direction are
// numbers to be found; C_X = 0.6 and C_Y = 0.9 are typical and fixed, since the square of the wind takes up what they
// are wrong by. Ignores: gusts, and the hull's own shelter. Revealed by the same motion on several headings, at rest
// and at speed. Confused with current (which acts below) and steady_force (which the wind is, while the craft is slow
// beside it).
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
    EffectParameter{.name = "arm", .unit = "m", .sigma = 0.3, .low = -50.0, .high = 50.0},
    EffectParameter{.name = "shift", .unit = "m", .sigma = 0.3, .low = -50.0, .high = 50.0}};
constexpr std::size_t kArm = 2, kShift = 3;
constexpr double kAirDensity = 1.23;                     // kg/m^3
constexpr double kAhead = 0.6, kAcross = 0.9;            // coefficients of small craft (Blendermann 1994)
constexpr std::array kWindBearings{0.0, 0.5, 1.0, 1.5};  // of pi, where a search begins
constexpr double kBreeze = 3.0;                          // m/s

constexpr double kNarrow = 0.7;  // beam over length from which on both laws are much the same

/// The frontal view over the side view, of a hull's side.
double narrowness(const Vehicle& vehicle) { return vehicle.hull.x() > 0.0 ? vehicle.hull.y() / vehicle.hull.x() : 0.0; }

class OnWhatStandsOut : public Form {
 public:
  explicit OnWhatStandsOut(NumberSet sought = {0, 1, kArm}) : Form{{.sought = sought, .obeys = 0}} {}
  FormName name(const Scene& scene) const override { return when(blows(scene), "alike from all sides"); }
  Starts starts(const Scene&) const override {
    Starts starts;
    for (const double bearing : kWindBearings)
      starts.push_back(
          {kBreeze * std::cos(bearing * std::numbers::pi), kBreeze * std::sin(bearing * std::numbers::pi), 0.0, 0.0});
    return starts;
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override { blow(motion, theta, 1.0, load); }

 protected:
  static bool blows(const Scene& scene) {
    const auto& dof = scene.vehicle->dof;
    return scene.vehicle->windage > 0.0 && scene.attitude && scene.velocity && (dof[0] || dof[1]);
  }
  /// `ahead`: the frontal view over the side view.
  static void blow(const Motion& motion, EffectTheta theta, double ahead, Load& load) {
    if (theta[0] == 0.0 && theta[1] == 0.0) return;  // no wind, and drag in still air belongs to the hull's
    const Eigen::Vector3d wind_B = motion.R_WB.transpose() * Eigen::Vector3d(theta[0], theta[1], 0.0);
    const Eigen::Vector2d v = motion.nu.head<2>(), past = wind_B.head<2>() - v;
    const double pressure = 0.5 * kAirDensity * motion.vehicle->windage;
    // What still air would do is taken off: it is part of the hull's own drag.
    const Eigen::Vector2d push = pressure * (past.norm() * past + v.norm() * v);
    load.wrench[0] += kAhead * ahead * push.x();
    load.wrench[1] += kAcross * push.y();
    const double along = past.norm() > 0.0 ? past.x() / past.norm() : 0.0;
    load.wrench[5] += (theta[kArm] + theta[kShift] * along) * kAcross * push.y();
  }
};

class OnTheHullsSide final : public OnWhatStandsOut {
 public:
  OnTheHullsSide() : OnWhatStandsOut{NumberSet::all()} {}
  FormName name(const Scene& scene) const override {
    const double share = narrowness(*scene.vehicle);
    return when(blows(scene) && share > 0.0 && share < kNarrow, "the hull's side");
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    blow(motion, theta, narrowness(*motion.vehicle), load);
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
                              forms(OnWhatStandsOut{}, OnTheHullsSide{})};
  return kEffect;
}

}  // namespace fathom::model::effects
