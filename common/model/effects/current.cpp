// Physics: water that moves steadily in the world frame; drag and added-mass terms feel the relative velocity
// nu_r = nu - [R_WB^T v_WF; 0] (Fossen 2011, sec. 8.1). Ignores: vertical flow, shear, change in time.
// Revealed by the same motion on several headings. Confused with a tether's constant pull and with W-B tilted by trim.
#include <array>

#include "common/model/effect.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCurrentParameters{EffectParameter{"v_N", "m/s", 0.1, -3.0, 3.0, 0.0, false, true},
                                        EffectParameter{"v_E", "m/s", 0.1, -3.0, 3.0, 0.0, false, true}};

class Current final : public Effect {
 public:
  std::string_view name() const override { return "current"; }
  std::string_view sentence() const override { return "The water itself moves steadily past the site."; }
  std::string_view revealed_by() const override { return "the same motion on opposite and crossing headings"; }
  std::span<const EffectParameter> parameters() const override { return kCurrentParameters; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const bool seen = scene.attitude && scene.velocity;
    return seen ? std::vector<std::string>{""} : std::vector<std::string>{};
  }
  std::vector<std::vector<double>> starts(const Scene&, int) const override { return {{0.01, 0.01}}; }

  void feel(Motion& motion, EffectTheta theta, int, std::span<const double>) const override {
    motion.v_WF_B += motion.R_WB.transpose() * Eigen::Vector3d(theta[0], theta[1], 0.0);
  }
};

}  // namespace

const Effect& current() {
  static const Current kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
