// Physics: near the surface a propeller draws air, or its jet breaks through, and it pushes less, the nearer the less:
//   f_i = (1 - min(1, a exp(-(h_i - z_s) / s))) f_c,i,   h_i = z + (R_WB p_BJ)_z
// h_i is the depth of that propeller, z_s the shallowest one at which the vehicle worked, for which the share a is
// told; s is the reach. Source: Minsaas, Faltinsen and Persson 1983 (loss over submergence, which an exponential
// follows); the fade is an assumption. Ignores: that air comes and goes by itself with waves and load. Revealed by the
// same thrust just below the surface and several hull's heights deeper. Confused with battery_sag where the vehicle was
// shallow at one end of the run alone.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/level_boundary.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kVentilationParameters{EffectParameter{"share_lost", "", 0.3, 0.0, 1.0},
                                            EffectParameter{.name = "reach",
                                                            .unit = "m",
                                                            .sigma = 0.3,
                                                            .low = boundary::kSmallestReach,
                                                            .high = boundary::kLongestReach,
                                                            .blurred = true},
                                            EffectParameter{"at_depth", "m"}};
constexpr std::size_t kVentilationReach = 1, kVentilationDepth = 2;
constexpr double kVentilationStart = 0.2;

class DrawsAir final : public Form {
 public:
  DrawsAir() : Form{{.sought = {0, kVentilationReach}, .given = {kVentilationDepth}}} {}
  FormName name(const Scene& scene) const override {
    if (!scene.position || scene.input_is_wrench || scene.vehicle->thrusters.empty()) return {};
    return when(boundary::near_surface(scene) && scene.p_high.z() - scene.p_low.z() > boundary::kSmallestRangeOfDepth);
  }
  Starts starts(const Scene& scene) const override {
    const double range = scene.p_high.z() - scene.p_low.z();
    Starts starts;
    for (const double share : boundary::kReaches)
      starts.push_back({kVentilationStart, std::min(share * range, boundary::kTypicalReach), scene.p_low.z()});
    return starts;
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (theta[0] == 0.0 || !by_thruster(motion)) return;
    const auto& thrusters = motion.vehicle->thrusters;
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
      if (is_no_propeller(motion, i)) continue;
      const double h = motion.p_WB.z() + motion.R_WB.row(2).dot(thrusters[static_cast<std::size_t>(i)].p_BJ);
      const double near = theta[0] * boundary::proximity_at(theta[kVentilationDepth] - h, theta[kVentilationReach]);
      motion.force[i] *= 1.0 - std::min(near, 1.0);
    }
  }
};

}  // namespace

const Effect& ventilation() {
  static const Effect kEffect{
      {.name = "ventilation",
       .sentence = "Near the surface propellers draw air and push less.",
       .revealed_by = "the same thrust just below the surface and several hull's heights deeper",
       .finding = "Propellers lose {share_lost %} of their push where the vehicle was shallowest",
       .stage = Stage::kWater,
       .amplitudes = 1,
       .feels_place = true},
      kVentilationParameters,
      forms(DrawsAir{})};
  return kEffect;
}

}  // namespace fathom::model::effects
