// Physics: surface waves move the water in circles of one frequency. Forms: `force`, a horizontal force
// (c cos wt + s sin wt) along bearing b; `heave`, the same along the vertical; `orbital`, the water's velocity itself,
// v_WF = e^(-kz) [ (c cos x + s sin x) n ; c sin x - s cos x down ], x = wt - k n . p, k = w^2/g (deep water, Airy;
// Fossen 2011, sec. 8.2), felt by drag, by the added mass and by the pressure gradient (Froude-Krylov). Frequency,
// phase and bearing are numbers to be found; starts come from the spectrum of what a linear regression leaves
// (tones.hpp). Ignores: a band of frequencies, short crests, drift, that the phase of several runs is not the same.
// Revealed by hovering for many periods. Confused with excitation at the same frequency, and with nothing when
// hovering.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kWaveParameters{EffectParameter{"cosine", "N", 5.0, -1e4, 1e4, 0.0, false, true},
                                     EffectParameter{"sine", "N", 5.0, -1e4, 1e4, 0.0, false, true},
                                     EffectParameter{"bearing", "rad", 3.0},
                                     EffectParameter{"frequency", "rad/s", 3.0, 0.0, 20.0}};
constexpr int kAmplitudes = 2;  // the leading numbers
constexpr std::size_t kWaveBearing = 2;
enum WaveForm { kForce, kHeave, kOrbital };
constexpr double kGravity = 9.81;          // m/s^2
constexpr double kMostDecay = 3.0;         // exponents of the decay with depth: the surface need not be at z = 0
constexpr double kFallbackInertia = 20.0;  // kg

class Wave final : public Effect {
 public:
  std::string_view name() const override { return "wave"; }
  std::string_view sentence() const override { return "Waves push the vehicle to and fro."; }
  std::string_view revealed_by() const override { return "hovering for many periods of the waves"; }
  std::span<const EffectParameter> parameters() const override { return kWaveParameters; }
  int amplitudes() const override { return kAmplitudes; }
  bool feels_place() const override { return true; }
  bool variants_matter() const override { return true; }
  bool takes_part(int variant, std::size_t number) const override {
    return variant != kHeave || number != kWaveBearing;
  }
  std::string_view unit(int variant, std::size_t number) const override {
    return variant == kOrbital && number < std::size_t{kAmplitudes} ? "m/s" : kWaveParameters[number].unit;
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    const auto& dof = scene.vehicle->dof;
    const bool sideways = (dof[0] || dof[1]) && !scene.tones_horizontal.empty();
    const bool upward = dof[2] && !scene.tones_vertical.empty();
    if (!sideways && !upward) return {};
    return {sideways ? "force" : "-", upward ? "heave" : "-", sideways && scene.position ? "orbital" : "-"};
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    std::vector<std::vector<double>> starts;
    for (const Tone& tone : variant == kHeave ? scene.tones_vertical : scene.tones_horizontal) {
      if (variant == kHeave) {
        starts.push_back({tone.cosine.z(), tone.sine.z(), 0.0, tone.omega});
        continue;
      }
      const Eigen::Vector2d cosine = tone.cosine.head<2>();
      const Eigen::Vector2d sine = tone.sine.head<2>();
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes{cosine * cosine.transpose() + sine * sine.transpose()};
      const Eigen::Vector2d n = axes.eigenvectors().col(1);
      const double c = cosine.dot(n), s = sine.dot(n), bearing = std::atan2(n.y(), n.x());
      if (variant == kForce) {
        starts.push_back({c, s, bearing, tone.omega});
      } else {  // the force is mostly inertia times the water's acceleration
        const double mass = scene.vehicle->mass > 0.0 ? 1.5 * scene.vehicle->mass : kFallbackInertia;
        const double cosine_v = -s / (mass * tone.omega), sine_v = c / (mass * tone.omega);
        starts.push_back({cosine_v, sine_v, bearing, tone.omega});
        // The same to and fro, travelling the other way: the water turns the other way, and no slope leads there.
        starts.push_back({-cosine_v, -sine_v, bearing + std::numbers::pi, tone.omega});
      }
    }
    return starts;
  }

  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double>) const override {
    if (variant != kOrbital || (theta[0] == 0.0 && theta[1] == 0.0)) return;
    const double omega = theta[3];
    const double k = omega * omega / kGravity;
    const Eigen::Vector3d n{std::cos(theta[2]), std::sin(theta[2]), 0.0};
    const double decay = std::exp(std::clamp(-k * motion.p_WB.z(), -kMostDecay, kMostDecay));
    const double phase = omega * motion.t - k * n.dot(motion.p_WB);
    const double along = decay * (theta[0] * std::cos(phase) + theta[1] * std::sin(phase));
    const double across = decay * (theta[0] * std::sin(phase) - theta[1] * std::cos(phase));
    const Eigen::Vector3d down = Eigen::Vector3d::UnitZ();
    motion.v_WF_B += motion.R_WB.transpose() * (along * n + across * down);
    motion.a_WF_B += motion.R_WB.transpose() * (-omega * across * n + omega * along * down);
  }
  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    if (variant == kOrbital) return;
    const double phase = theta[3] * motion.t;
    const double force = theta[0] * std::cos(phase) + theta[1] * std::sin(phase);
    const Eigen::Vector3d n = variant == kForce ? Eigen::Vector3d{std::cos(theta[2]), std::sin(theta[2]), 0.0}
                                                : Eigen::Vector3d::UnitZ().eval();
    load.wrench.head<3>() += force * (motion.R_WB.transpose() * n);
  }
};

}  // namespace

const Effect& wave() {
  static const Wave kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
