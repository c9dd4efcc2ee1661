// Physics: the command reaches the propellers late by a fixed time (bus, ESC, on-board computer), or the log's clocks
// of command and motion differ by as much. f(t) = f_c(t - T). Ignores: jitter; a delay of its own per thruster.
// Revealed by steps and fast reversals. Confused with thruster_lag (a delay shifts, a lag also rounds) and, over a
// narrow band, with added mass.
#include <array>

#include "common/model/effect.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"delay", "s", 0.1, 0.0, 1.5, 0.0, true}};

class ThrusterDelay final : public Effect {
 public:
  std::string_view name() const override { return "thruster_delay"; }
  std::string_view sentence() const override { return "Thrust follows the logged command late by a fixed time."; }
  std::string_view revealed_by() const override {
    return "steps and reversals of thrust, each held for several seconds";
  }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  bool feels_motion() const override { return false; }
  std::vector<std::vector<double>> starts(const Scene&, int) const override { return {{0.05}, {0.2}, {0.5}}; }

  void feel(Motion& motion, EffectTheta theta, int, std::span<const double>) const override {
    if (theta[0] != 0.0 && motion.input != nullptr) motion.input->at(motion.t - theta[0], motion.force);
  }
};

}  // namespace

const Effect& thruster_delay() {
  static const ThrusterDelay kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
