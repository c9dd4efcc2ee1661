// Physics: as bottom_effect, with an upright wall: planes n . p = const with n = (cos b, sin b, 0) toward it, felt by
// `force`, w = -a f R_WB^T n (a > 0 pushes away, a < 0 draws near), by `drag`: the hull's own translational drag grows
// by the share c f, or by `suction`: w = a v_t^2 / (d - n . p)^4 R_WB^T n, v_t the speed along the wall. Each falls
// with the inverse square of the gap to the wall, f = 1 / (d - n . p)^2, or exponentially, f = exp((n . p - d_a) / s),
// told for a place d_a as near as the vehicle came (boundary.hpp). Bearing b and the wall's distance d from the site's
// origin, or the reach s, are numbers to be found. Source: as there. Ignores: more than one wall (each is a form of its
// own search), growth of the added mass, the jets' own reflection. Revealed by moving along and toward each side of the
// site. Confused with tether_tension (pulls along a line to a point) and, with little motion across, with current.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/boundary.hpp"
#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

using namespace boundary;

constexpr std::array kWallEffectParameters{
    EffectParameter{"strength", "N m^2", 5.0, -1e4, 1e4}, EffectParameter{"bearing", "rad", 3.0},
    EffectParameter{"distance", "m", 20.0},
    EffectParameter{
        .name = "reach", .unit = "m", .sigma = 0.5, .low = kSmallestReach, .high = kLongestReach, .blurred = true},
    EffectParameter{"at_distance", "m"}};
constexpr std::size_t kBearing = 1, kDistance = 2, kReach = 3, kAtDistance = 4;
constexpr int kWallEffectBearings = 8;
constexpr std::array kWallEffectGaps{0.3, 1.0};    // m beyond the box of positions
constexpr double kReachShare = 0.2;                // of the width of that box, where a search begins
constexpr double kWallEffectSmallestRange = 0.05;  // m

Eigen::Vector3d toward(EffectTheta theta) { return {std::cos(theta[kBearing]), std::sin(theta[kBearing]), 0.0}; }

class NearWall final : public Form {
 public:
  explicit NearWall(const Law& law)
      : Form{traits_of(law, {0, kBearing, law.exponential() ? kReach : kDistance},
                       law.exponential() ? NumberSet{kAtDistance} : NumberSet{})},
        law_{law} {}
  FormName name(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const double range = (scene.p_high - scene.p_low).head<2>().maxCoeff();
    if (!scene.position || !scene.attitude || range <= kWallEffectSmallestRange) return {};
    const bool pushed = dof[0] || dof[1], moves = pushed || dof[2];
    return when(law_.shows(pushed, moves, (dof[0] && dof[1]) || (pushed && dof[2])), law_.name);
  }
  /// A wall that takes drag away or drives off is none, nor one behind which the middle of the water worked in lies.
  bool possible(EffectTheta theta, const Scene& scene) const override {
    if (law_.one_sided() && theta[0] < 0.0) return false;
    return law_.exponential() || theta[kDistance] > toward(theta).dot(0.5 * (scene.p_low + scene.p_high));
  }
  Starts starts(const Scene& scene) const override {
    const Eigen::Vector2d middle = 0.5 * (scene.p_high + scene.p_low).head<2>();
    const Eigen::Vector2d half = 0.5 * (scene.p_high - scene.p_low).head<2>();
    const double force = 0.1 * std::max(scene.tau_rms.head<2>().norm(), 1e-2);
    const double size = law_.multiplies() ? kStartShare : force;
    const double speed = scene.nu_rms.head<3>().norm();
    Starts starts;
    for (int k = 0; k < kWallEffectBearings; ++k) {
      const double bearing = 2.0 * std::numbers::pi * k / kWallEffectBearings;
      const Eigen::Vector2d n{std::cos(bearing), std::sin(bearing)};
      const double width = n.cwiseAbs().dot(half), edge = n.dot(middle) + width;
      if (law_.exponential()) {
        starts.push_back({size, bearing, 0.0, std::min(2.0 * kReachShare * width, kTypicalReach), edge});
        continue;
      }
      for (const double gap : kWallEffectGaps) {
        const double far = gap + 0.25 * width;  // where it should be worth a tenth of the thrust
        starts.push_back({strength_at(law_, force, far, speed), bearing, edge + gap, 0.0, 0.0});
      }
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const Eigen::Vector3d n = toward(theta);
    const double along = n.dot(motion.p_WB);
    const double near = theta[0] * (law_.exponential() ? proximity_at(along - theta[kAtDistance], theta[kReach])
                                                       : nearness(law_, theta[kDistance] - along));
    press(law_, near, motion.R_WB.transpose() * n, motion.nu_r().head<3>(), load);
  }

 private:
  Law law_;
};

}  // namespace

const Effect& wall_effect() {
  static const Effect kEffect{{.name = "wall_effect",
                               .sentence = "A wall beside is felt when it is near.",
                               .revealed_by = "moving along and toward every side of the site",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .forms_coexist = true,
                               .feels_motion = false,
                               .feels_place = true},
                              kWallEffectParameters,
                              form_per_law<NearWall>()};
  return kEffect;
}

}  // namespace fathom::model::effects
