// Physics: a tether to a fixed anchor, slack up to its length L, then a spring: T = k max(|p_A - p| - L, 0) toward the
// anchor, attached at Bo. Ignores: drag and weight of the tether, a point of attachment away from Bo, hysteresis.
// Revealed by slow excursions to all sides. Confused with current (which follows speed and heading, not place) and W-B.
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/effect.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"stiffness", "N/m", 2.0, 0.0, 1000.0},
                                 EffectParameter{"slack_length", "m", 3.0, 0.0, 500.0},
                                 EffectParameter{"anchor_N", "m", 5.0}, EffectParameter{"anchor_E", "m", 5.0},
                                 EffectParameter{"anchor_D", "m", 3.0}};

constexpr double kStartStiffness = 0.5;  // N/m

class TetherTension final : public Effect {
 public:
  std::string_view name() const override { return "tether_tension"; }
  std::string_view sentence() const override { return "A tether pulls toward its fixed end."; }
  std::string_view revealed_by() const override { return "slow excursions to every side of the site, with pauses"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  bool feels_place() const override { return true; }
  std::vector<std::string> variants(const Scene& scene) const override {
    const bool seen = scene.position && scene.attitude;
    return seen ? std::vector<std::string>{""} : std::vector<std::string>{};
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int) const override {
    // Anchors: the middle of the water worked in, and eight directions half way out and just outside it. Slack so that
    // the tether is taut everywhere, in half of the water, or only far away.
    const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high);
    const double reach = std::max(0.5 * (scene.p_high - scene.p_low).head<2>().norm(), 0.5);
    std::vector<std::vector<double>> starts;
    const auto add = [&](double bearing, double distance, double slack) {
      starts.push_back({kStartStiffness, slack, middle.x() + distance * std::cos(bearing),
                        middle.y() + distance * std::sin(bearing), middle.z()});
    };
    for (const double slack : {0.0, 0.4, 0.7}) add(0.0, 0.0, slack * reach);
    for (int k = 0; k < 8; ++k) {
      const double bearing = 0.25 * std::numbers::pi * k;
      add(bearing, 0.5 * reach, 0.7 * reach);
      add(bearing, 1.2 * reach, 0.0);
      add(bearing, 1.2 * reach, 1.2 * reach);
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, int, Load& load) const override {
    const Eigen::Vector3d to_anchor = Eigen::Vector3d(theta[2], theta[3], theta[4]) - motion.p_WB;
    const double distance = to_anchor.norm();
    const double stretch = distance - theta[1];
    if (stretch <= 0.0 || distance < 1e-9) return;
    load.wrench.head<3>() += motion.R_WB.transpose() * to_anchor * (theta[0] * stretch / distance);
  }
};

}  // namespace

const Effect& tether_tension() {
  static const TetherTension kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
