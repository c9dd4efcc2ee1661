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

constexpr std::array kWaveParameters{
    EffectParameter{.name = "cosine", .unit = "N", .sigma = 5.0, .low = -1e4, .high = 1e4},
    EffectParameter{.name = "sine", .unit = "N", .sigma = 5.0, .low = -1e4, .high = 1e4},
    EffectParameter{"bearing", "rad", 3.0}, EffectParameter{"frequency", "rad/s", 3.0, 0.0, 20.0}};
constexpr std::size_t kWaveBearing = 2, kFrequency = 3;
constexpr double kGravity = 9.81;          // m/s^2
constexpr double kMostDecay = 3.0;         // exponents of the decay with depth: the surface need not be at z = 0
constexpr double kFallbackInertia = 20.0;  // kg
constexpr double kDrawnVelocity = 0.02;    // m/s of the water per N of the prior: the same number is both

/// Of the forms that go along a bearing: a start per tone and way that it may travel.
struct Along {
  double cosine, sine, bearing;
  explicit Along(const Tone& tone) {
    const Eigen::Vector2d of_cosine = tone.cosine.head<2>(), of_sine = tone.sine.head<2>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes{of_cosine * of_cosine.transpose() +
                                                              of_sine * of_sine.transpose()};
    const Eigen::Vector2d n = axes.eigenvectors().col(1);
    cosine = of_cosine.dot(n);
    sine = of_sine.dot(n);
    bearing = std::atan2(n.y(), n.x());
  }
};

bool sideways(const Scene& scene) {
  return (scene.vehicle->dof[0] || scene.vehicle->dof[1]) && !scene.tones_horizontal.empty();
}

/// N, at the moment.
double swinging(const Motion& motion, EffectTheta theta) {
  const double phase = theta[kFrequency] * motion.t;
  return theta[0] * std::cos(phase) + theta[1] * std::sin(phase);
}

Eigen::Vector3d along(EffectTheta theta) { return {std::cos(theta[kWaveBearing]), std::sin(theta[kWaveBearing]), 0.0}; }

class HorizontalForce final : public Form {
 public:
  FormName name(const Scene& scene) const override { return when(sideways(scene), "force"); }
  Starts starts(const Scene& scene) const override {
    Starts starts;
    for (const Tone& tone : scene.tones_horizontal) {
      const Along way{tone};
      starts.push_back({way.cosine, way.sine, way.bearing, tone.omega});
    }
    return starts;
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    load.wrench.head<3>() += swinging(motion, theta) * (motion.R_WB.transpose() * along(theta));
  }
};

class Heave final : public Form {
 public:
  Heave() : Form{{.sought = {0, 1, kFrequency}}} {}
  FormName name(const Scene& scene) const override {
    return when(scene.vehicle->dof[2] && !scene.tones_vertical.empty(), "heave");
  }
  Starts starts(const Scene& scene) const override {
    Starts starts;
    for (const Tone& tone : scene.tones_vertical) starts.push_back({tone.cosine.z(), tone.sine.z(), 0.0, tone.omega});
    return starts;
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
    load.wrench.head<3>() += swinging(motion, theta) * (motion.R_WB.transpose() * n);
  }
};

class OrbitalVelocity final : public Form {
 public:
  OrbitalVelocity() : Form{{.unit = "m/s", .drawn = kDrawnVelocity}} {}
  FormName name(const Scene& scene) const override { return when(sideways(scene) && scene.position, "orbital"); }
  Starts starts(const Scene& scene) const override {
    Starts starts;
    for (const Tone& tone : scene.tones_horizontal) {  // the force is mostly inertia times the water's acceleration
      const Along way{tone};
      const double mass = scene.vehicle->mass > 0.0 ? 1.5 * scene.vehicle->mass : kFallbackInertia;
      const double cosine_v = -way.sine / (mass * tone.omega), sine_v = way.cosine / (mass * tone.omega);
      starts.push_back({cosine_v, sine_v, way.bearing, tone.omega});
      // The same to and fro, travelling the other way: the water turns the other way, and no slope leads there.
      starts.push_back({-cosine_v, -sine_v, way.bearing + std::numbers::pi, tone.omega});
    }
    return starts;
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (theta[0] == 0.0 && theta[1] == 0.0) return;
    const double omega = theta[kFrequency];
    const double k = omega * omega / kGravity;
    const Eigen::Vector3d n = along(theta);
    const double decay = std::exp(std::clamp(-k * motion.p_WB.z(), -kMostDecay, kMostDecay));
    const double phase = omega * motion.t - k * n.dot(motion.p_WB);
    const double forth = decay * (theta[0] * std::cos(phase) + theta[1] * std::sin(phase));
    const double across = decay * (theta[0] * std::sin(phase) - theta[1] * std::cos(phase));
    const Eigen::Vector3d down = Eigen::Vector3d::UnitZ();
    motion.v_WF_B += motion.R_WB.transpose() * (forth * n + across * down);
    motion.a_WF_B += motion.R_WB.transpose() * (-omega * across * n + omega * forth * down);
  }
};

}  // namespace

const Effect& wave() {
  static const Effect kEffect{{.name = "wave",
                               .sentence = "Waves push the vehicle to and fro.",
                               .revealed_by = "hovering for many periods of the waves",
                               .stage = Stage::kWater,
                               .amplitudes = 2,
                               .forms_coexist = true,
                               .feels_place = true},
                              kWaveParameters,
                              forms(HorizontalForce{}, Heave{}, OrbitalVelocity{})};
  return kEffect;
}

}  // namespace fathom::model::effects
