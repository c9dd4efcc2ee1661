// Physics: a tether to a fixed anchor, slack up to its length L, then a spring: T = k max(|p_A - p| - L, 0) toward the
// anchor. Source: Hooke's law of a cable that carries no compression. Made fast at Bo, or at a place p_BC in B that is
// to be found (attachment.hpp): it then ends at p + R_WB p_BC and turns the vehicle by p_BC x T. Ignores: drag and
// weight of the tether, hysteresis. Revealed by slow excursions to all sides, its place by pulls from ahead and abeam.
// Confused with current (which follows speed and heading, not place) and W-B; the turning with restoring_moment and a
// thruster's gain.
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/attachment.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kTetherTensionParameters{EffectParameter{"stiffness", "N/m", 2.0, 0.0, 1000.0},
                                              EffectParameter{"slack_length", "m", 3.0, 0.0, 500.0},
                                              EffectParameter{"anchor_N", "m", 5.0},
                                              EffectParameter{"anchor_E", "m", 5.0},
                                              EffectParameter{"anchor_D", "m", 3.0},
                                              kAttachment[0],
                                              kAttachment[1],
                                              kAttachment[2]};
constexpr std::size_t kTetherTensionAttached = 5;  // its first number

constexpr double kStartStiffness = 0.5;  // N/m
constexpr double kSteady = 10.0;         // times the reach of what was visited: direction and size change by a tenth

class ElasticLine final : public OneOfMany {
 public:
  explicit ElasticLine(int set) : OneOfMany{{.sought = numbers_of(set, kTetherTensionAttached)}}, set_{set} {}
  FormName name(const Scene& scene) const override {
    return scene.position && scene.attitude ? attachment_name(set_, attachment_set(*scene.vehicle)) : std::nullopt;
  }
  /// Over so little of its length the pull neither turns nor grows.
  Unlisted looks_like(EffectTheta theta, const Scene& scene) const override {
    const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high);
    const double stretch = (Eigen::Vector3d(theta[2], theta[3], theta[4]) - middle).norm() - theta[1];
    if (stretch < kSteady * 0.5 * (scene.p_high - scene.p_low).norm()) return {};
    return {"a steady force in one direction of the world", "going so far that a tether's pull would turn, or grow"};
  }
  Starts starts(const Scene& scene) const override {
    // Anchors: the middle of the water worked in, and eight directions half way out and just outside it. Slack so that
    // the tether is taut everywhere, in half of the water, or only far away.
    const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high);
    const double reach = std::max(0.5 * (scene.p_high - scene.p_low).head<2>().norm(), 0.5);
    Starts starts;
    const auto add = [&](double bearing, double distance, double slack) {
      starts.push_back({kStartStiffness, slack, middle.x() + distance * std::cos(bearing),
                        middle.y() + distance * std::sin(bearing), middle.z(), 0.0, 0.0, 0.0});
    };
    if (set_ == 0) add(0.0, 0.0, 0.0);
    for (const double slack : {0.4, 0.7}) add(0.0, 0.0, slack * reach);
    for (int k = 0; k < 8; ++k) {
      const double bearing = 0.25 * std::numbers::pi * k;
      add(bearing, 1.2 * reach, 1.2 * reach);
      if (set_ != 0) continue;  // where it is made fast is found on the way: half of the starts do
      add(bearing, 0.5 * reach, 0.7 * reach);
      add(bearing, 1.2 * reach, 0.0);
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const Eigen::Vector3d p_BC = components(theta, set_, kTetherTensionAttached);
    Eigen::Vector3d to_anchor = Eigen::Vector3d(theta[2], theta[3], theta[4]) - motion.p_WB;
    if (set_ != 0) to_anchor -= motion.R_WB * p_BC;
    const double distance = to_anchor.norm();
    const double stretch = distance - theta[1];
    if (stretch <= 0.0 || distance < 1e-9) return;
    const Eigen::Vector3d pull = motion.R_WB.transpose() * to_anchor * (theta[0] * stretch / distance);
    load.wrench.head<3>() += pull;
    if (set_ != 0) load.wrench.tail<3>() += p_BC.cross(pull);
  }

 private:
  int set_;
};

}  // namespace

const Effect& tether_tension() {
  static const Effect kEffect{{.name = "tether_tension",
                               .sentence = "A tether pulls toward its fixed end.",
                               .revealed_by = "slow excursions to every side of the site, with pauses",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .feels_motion = false,
                               .feels_place = true},
                              kTetherTensionParameters,
                              form_per_set<ElasticLine>()};
  return kEffect;
}

}  // namespace fathom::model::effects
