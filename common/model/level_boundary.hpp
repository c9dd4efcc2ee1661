// What bottom and surface have in common beside boundary.hpp: a level plane, felt by what comes near it.
#pragma once

#include <algorithm>
#include <array>

#include "common/model/boundary.hpp"
#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::boundary {

constexpr std::size_t kPlaneDepth = 1, kReach = 2, kAtDepth = 3;  // of the numbers; 0 is the strength
constexpr double kSmallestRangeOfDepth = 0.05;                    // m: in less, nothing shows that changes with it
constexpr std::array kGaps{0.15, 0.4, 1.0, 2.5};                  // m beyond the nearest place visited
constexpr std::array kReaches{0.1, 0.3, 0.9};                     // of the range of depth

/// Which plane: on which side, and what else lies there.
struct Level {
  double down;          ///< 1: below the vehicle, -1: above it
  Unlisted looks_like;  ///< what pushes off exponentially too
};

/// Whether the runs came so near to the surface, from which depth is counted, that it may be felt: two of the longest
/// reaches.
[[nodiscard]] inline bool near_surface(const Scene& scene) { return scene.p_low.z() < 2.0 * kLongestReach; }

class NearLevel : public Form {
 public:
  NearLevel(const Law& law, const Level& level)
      : Form{traits_of(law, {0, law.exponential() ? kReach : kPlaneDepth},
                       law.exponential() ? NumberSet{kAtDepth} : NumberSet{}, law.multiplies() ? kOneDrag : kOneForce)},
        law_{law},
        level_{level} {}
  FormName name(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    if (!scene.position || scene.p_high.z() - scene.p_low.z() <= kSmallestRangeOfDepth) return {};
    return when(law_.shows(dof[2], dof[0] || dof[1] || dof[2], dof[0] || dof[1]), law_.name);
  }
  /// A plane that takes drag away or drives off is none, nor one within the middle of the water worked in.
  bool possible(EffectTheta theta, const Scene& scene) const final {
    if (law_.one_sided() && theta[0] < 0.0) return false;
    return law_.exponential() ||
           level_.down * theta[kPlaneDepth] > level_.down * 0.5 * (scene.p_low.z() + scene.p_high.z());
  }
  Unlisted looks_like(EffectTheta theta, const Scene&) const final {
    return law_.exponential() && law_.felt == Felt::kPush && theta[0] > 0.0 ? level_.looks_like : Unlisted{};
  }
  Starts starts(const Scene& scene) const final {
    const double range = scene.p_high.z() - scene.p_low.z();
    const double nearest = level_.down > 0.0 ? scene.p_high.z() : scene.p_low.z();
    const double force = 0.1 * std::max(scene.tau_rms.head<3>().norm(), 1e-2);
    const double size = law_.multiplies() ? kStartShare : force, speed = scene.nu_rms.head<2>().norm();
    Starts starts;
    if (law_.exponential()) {
      for (const double share : kReaches)
        starts.push_back({size, 0.0, std::min(share * range, kTypicalReach), nearest});
      return starts;
    }
    for (const double gap : kGaps) {
      const double height = gap + 0.25 * range;  // where it should be worth a tenth of the thrust
      starts.push_back({strength_at(law_, force, height, speed), nearest + level_.down * gap, 0.0, 0.0});
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const final {
    const double z = motion.p_WB.z();
    const double near =
        theta[0] * (law_.exponential() ? proximity_at(level_.down * (z - theta[kAtDepth]), theta[kReach])
                                       : nearness(law_, level_.down * (theta[kPlaneDepth] - z)));
    press(law_, near, level_.down * motion.R_WB.row(2).transpose(), motion.nu_r().head<3>(), load);
  }

 private:
  enum OnePlane { kOneForce, kOneDrag };  // obeys one law each
  Law law_;
  Level level_;
};

}  // namespace fathom::model::boundary
