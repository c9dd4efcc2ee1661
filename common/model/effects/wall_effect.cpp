// Physics: as bottom_effect, with an upright wall: the plane n . p = d with n = (cos b, sin b, 0), felt at the gap
// s = d - n . p by `force`, w = -a / s^2 R_WB^T n (a > 0 pushes away, a < 0 sucks: Bernoulli between hull and wall), or
// by `drag`, w = -c / s^2 |v_r| v_r. Bearing b and distance d from the site's origin are numbers to be found. Ignores:
// more than one wall (each is a form of its own search), growth of the added mass, the jets' own reflection. Revealed
// by moving along and toward each side of the site. Confused with tether_tension (pulls along a line to a point) and,
// with little motion across, with current.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/boundary.hpp"
#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kParameters{EffectParameter{"strength", "N m^2", 5.0, -1e4, 1e4},
                                 EffectParameter{"bearing", "rad", 3.0}, EffectParameter{"distance", "m", 20.0}};
constexpr int kForce = 0;
constexpr int kBearings = 8;
constexpr std::array kGaps{0.3, 1.0};    // m beyond the box of positions
constexpr double kSmallestRange = 0.05;  // m

class WallEffect final : public Effect {
 public:
  std::string_view name() const override { return "wall_effect"; }
  std::string_view sentence() const override { return "A wall beside is felt when it is near."; }
  std::string_view revealed_by() const override { return "moving along and toward every side of the site"; }
  std::span<const EffectParameter> parameters() const override { return kParameters; }
  int amplitudes() const override { return 1; }
  bool feels_motion() const override { return false; }
  bool feels_place() const override { return true; }
  /// A wall that takes drag away is none.
  bool possible(const Eigen::Vector3d& p_WB, EffectTheta theta, int variant) const override {
    if (variant != kForce && theta[0] < 0.0) return false;
    return theta[2] > std::cos(theta[1]) * p_WB.x() + std::sin(theta[1]) * p_WB.y();
  }
  bool variants_matter() const override { return true; }
  std::string_view unit(int variant, std::size_t number) const override {
    return number == 0 && variant != kForce ? "N m^2/(m/s)^2" : kParameters[number].unit;
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const double range = (scene.p_high - scene.p_low).head<2>().maxCoeff();
    if (!scene.position || !scene.attitude || range <= kSmallestRange) return {};
    return {dof[0] || dof[1] ? "force" : "-", dof[0] || dof[1] || dof[2] ? "drag" : "-"};
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const Eigen::Vector2d middle = 0.5 * (scene.p_high + scene.p_low).head<2>();
    const Eigen::Vector2d half = 0.5 * (scene.p_high - scene.p_low).head<2>();
    const double speed = std::max(scene.nu_rms.head<3>().norm(), 1e-2);
    const double force = 0.1 * std::max(scene.tau_rms.head<2>().norm(), 1e-2);
    std::vector<std::vector<double>> starts;
    for (int k = 0; k < kBearings; ++k) {
      const double bearing = 2.0 * std::numbers::pi * k / kBearings;
      const Eigen::Vector2d n{std::cos(bearing), std::sin(bearing)};
      const double reach = n.cwiseAbs().dot(half);
      for (const double gap : kGaps) {
        const double far = gap + 0.25 * reach;  // where it should be worth a tenth of the thrust
        starts.push_back(
            {force * far * far / (variant == kForce ? 1.0 : speed * speed), bearing, n.dot(middle) + reach + gap});
      }
    }
    return starts;
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const Eigen::Vector3d n{std::cos(theta[1]), std::sin(theta[1]), 0.0};
    const double near = theta[0] * proximity(theta[2] - n.dot(motion.p_WB));
    if (variant == kForce) {
      load.wrench.head<3>() -= near * (motion.R_WB.transpose() * n);
    } else {
      const Eigen::Vector3d v_r = motion.nu_r().head<3>();
      load.wrench.head<3>() -= near * v_r.norm() * v_r;
    }
  }
};

}  // namespace

const Effect& wall_effect() {
  static const WallEffect kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
