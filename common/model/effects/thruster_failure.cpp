// Physics: from a moment on, one thruster gives only a part of its thrust (weed, a lost blade, a dying controller):
// f_i = (1 - a s(t - t_0)) f_c,i, with s a smooth step of 1 s. Two numbers: share lost a and moment t_0 (Omerdic and
// Roberts 2004: faults of open-frame vehicles as loss of one thruster's authority). Ignores: recovery, a slow decline
// (battery_sag), that several runs seldom fail at the same time of the run. Revealed by repeating the same motion
// before and after. Confused with thruster_gain (fails from the start on), payload_change (acts on all motions).
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/onset.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterFailureParameters{EffectParameter{"share_lost", "", 0.5, 0.0, 1.2}, kOnsetParameter};
constexpr int kThrusterFailureMoments = 8;
constexpr double kTypicalLoss = 0.3;

class ThrusterFailure final : public Effect {
 public:
  std::string_view name() const override { return "thruster_failure"; }
  std::string_view sentence() const override { return "One thruster loses part of its thrust at some moment."; }
  std::string_view revealed_by() const override { return "the same motions in every part of the run"; }
  std::span<const EffectParameter> parameters() const override { return kThrusterFailureParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    if (scene.input_is_wrench || scene.t_high - scene.t_low <= kOnsetDuration) return {};
    std::vector<std::string> names;
    for (std::size_t i = 0; i < scene.vehicle->thrusters.size(); ++i) {
      const bool used =
          scene.force_rms.size() > static_cast<Eigen::Index>(i) && scene.force_rms[static_cast<Eigen::Index>(i)] > 0.0;
      names.push_back(used ? scene.vehicle->thrusters[i].name : "-");
    }
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int) const override {
    std::vector<std::vector<double>> starts;
    for (const double moment : onset_starts(scene.t_low, scene.t_high, kThrusterFailureMoments)) {
      starts.push_back({kTypicalLoss, std::max(moment, 0.0)});
    }
    return starts;
  }

  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double>) const override {
    if (variant < motion.force.size()) motion.force[variant] *= 1.0 - theta[0] * onset_share(motion.t, theta[1]);
  }
};

}  // namespace

const Effect& thruster_failure() {
  static const ThrusterFailure kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
