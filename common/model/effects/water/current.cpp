// Physics: water that moves steadily in the world frame; drag and added-mass terms feel the relative velocity
// nu_r = nu - [R_WB^T v_WF; 0] (Fossen 2011, sec. 8.1). Ignores: vertical flow, shear, change in time.
// Revealed by the same motion on several headings. Confused with a tether's constant pull and with W-B tilted by trim.
#include <array>

#include "common/model/effect.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCurrentParameters{
    EffectParameter{.name = "v_N", .unit = "m/s", .sigma = 0.1, .low = -3.0, .high = 3.0, .of_run = true},
    EffectParameter{.name = "v_E", .unit = "m/s", .sigma = 0.1, .low = -3.0, .high = 3.0, .of_run = true}};

class SteadyWater final : public Form {
 public:
  FormName name(const Scene& scene) const override { return when(scene.attitude && scene.velocity); }
  Starts starts(const Scene&) const override { return {{0.01, 0.01}}; }

  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    motion.v_WF_B += motion.R_WB.transpose() * Eigen::Vector3d(theta[0], theta[1], 0.0);
  }
};

}  // namespace

const Effect& current() {
  static const Effect kEffect{{.name = "current",
                               .sentence = "The water itself moves steadily past the site.",
                               .revealed_by = "the same motion on opposite and crossing headings",
                               .stage = Stage::kWater},
                              kCurrentParameters,
                              forms(SteadyWater{})};
  return kEffect;
}

}  // namespace fathom::model::effects
