// Physics: from a moment on, one thruster gives only a part of its thrust (weed, a lost blade, a dying controller):
// f_i = (1 - a s(t - t_0)) f_c,i, with s a smooth step of 1 s. Two numbers: share lost a and moment t_0 (Omerdic and
// Roberts 2004: faults of open-frame vehicles as loss of one thruster's authority). Ignores: recovery, a slow decline
// (battery_sag), that several runs seldom fail at the same time of the run. Revealed by repeating the same motion
// before and after. Confused with thruster_gain (fails from the start on), payload_change (acts on all motions).
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/one_of_many.hpp"
#include "common/model/onset.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterFailureParameters{EffectParameter{"share_lost", "", 0.5, 0.0, 1.2}, kOnsetParameter};
constexpr int kThrusterFailureMoments = 8;
constexpr double kTypicalLoss = 0.3;

class OneFails final : public OfThruster {
 public:
  using OfThruster::OfThruster;
  FormName name(const Scene& scene) const override {
    if (scene.input_is_wrench || scene.t_high - scene.t_low <= kOnsetDuration) return {};
    if (!exists(scene)) return {};
    return when(scene.force_rms.size() > thruster_ && scene.force_rms[thruster_] > 0.0,
                scene.vehicle->thrusters[place()].name);
  }
  Starts starts(const Scene& scene) const override {
    Starts starts;
    for (const double moment : onset_starts(scene.t_low, scene.t_high, kThrusterFailureMoments)) {
      starts.push_back({kTypicalLoss, std::max(moment, 0.0)});
    }
    return starts;
  }

  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (thruster_ < motion.force.size()) motion.force[thruster_] *= 1.0 - theta[0] * onset_share(motion.t, theta[1]);
  }
};

}  // namespace

const Effect& thruster_failure() {
  static const Effect kEffect{{.name = "thruster_failure",
                               .sentence = "One thruster loses part of its thrust at some moment.",
                               .revealed_by = "the same motions in every part of the run",
                               .finding = "{thruster} lost {share_lost %} of its thrust at {onset}",
                               .stage = Stage::kThrust,
                               .amplitudes = 1,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kThrusterFailureParameters,
                              form_per_thruster<OneFails>()};
  return kEffect;
}

}  // namespace fathom::model::effects
