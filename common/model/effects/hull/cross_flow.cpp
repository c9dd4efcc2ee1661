// Physics: water that crosses a hull drags on each strip of it by that strip's own speed across, v + x r or w - x q
// (strip theory of cross-flow drag: Hoerner 1965; Faltinsen 1990, ch. 6; Fossen 2021, sec. 6.4):
//   Y = -c mean over x of (v_r + x r)|v_r + x r|,  N = -c mean of x (v_r + x r)|v_r + x r|,  |x| <= L / 2,
//   Z and M by w_r - x q likewise, c = 1/2 rho C_d times the area that is crossed.
// The base model has what strips do where the hull only drifts or only turns, Y_v|v| and N_r|r|; here is what they do
// where it does both: the same integrals less c v_r|v_r| and c L^3 / 32 r|r|, so that base numbers keep their meaning.
// Strips that differ fore and aft, c (1 + d x / (L/2)) with f = c d, add Y = -f mean of x / (L/2) (v_r + x r)|v_r + x
// r| and N likewise, N_v|v| and Y_r|r| among it. L is the hull's length where the vehicle's file has one, else a number
// to be found. Ignores: drag that depends on Reynolds' number. Revealed by drifting and turning at once, one way and
// the other, and each alone. Confused with body_lift where the speed ahead hardly changes, f with what stall leaves of
// it.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect_size.hpp"
#include "common/model/speed_products.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCrossFlowParameters{
    EffectParameter{.name = "drag", .unit = "N/(m/s)^2", .sigma = 150.0, .low = 0.0},
    EffectParameter{.name = "fore", .unit = "N/(m/s)^2", .sigma = 75.0},
    EffectParameter{.name = "length", .unit = "m", .sigma = 2.0, .low = 0.1, .high = 20.0}};
constexpr double kSlowest = 0.01;  // m/s RMS of the middle, and of the ends by turning: less shows no product
// Gauss and Legendre's rule of eight points: nodes and half the weights, on one side of the middle.
constexpr std::array kNodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array kShares{0.1813418916891810, 0.1568533229389437, 0.1111905172266872, 0.0506142681451881};

double squared(double speed) { return speed * std::abs(speed); }

/// `across` 1 with yaw, or 2 with pitch.
class Strips final : public Form {
 public:
  Strips(Eigen::Index across, bool stated, const char* name)
      : Form{stated ? FormTraits{.sought = {0, 1}, .given = {2}, .obeys = static_cast<int>(across)}
                    : FormTraits{.obeys = static_cast<int>(across)}},
        across_{across},
        stated_{stated},
        name_{name} {}
  FormName name(const Scene& scene) const override {
    const Vehicle& vehicle = *scene.vehicle;
    const bool turns = 0.25 * length(vehicle) * scene.nu_rms[turning()] > kSlowest;
    return when(lives_by_flow(vehicle) && (vehicle.hull.x() > 0.0) == stated_ &&
                    vehicle.dof[static_cast<std::size_t>(across_)] &&
                    vehicle.dof[static_cast<std::size_t>(turning())] && scene.nu_rms[across_] > kSlowest && turns,
                name_);
  }
  Starts starts(const Scene& scene) const override {
    const double c = 0.1 * kCrossFlowParameters[0].sigma * size_factor(*scene.vehicle, kCrossFlowParameters[0].unit);
    const double middle = length(*scene.vehicle);
    if (stated_) return {{c, 0.0, middle}};
    return {{c, 0.0, 0.5 * middle}, {c, 0.0, middle}, {c, 0.0, 2.0 * middle}};
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const double c = theta[0], f = theta[1], half = 0.5 * theta[2];
    if (c == 0.0 && f == 0.0) return;
    const Vector6d nu_r = motion.nu_r();
    const double side = across_ == 1 ? 1.0 : -1.0;
    const double along = nu_r[across_], turn = side * nu_r[turning()];
    double force = -c * squared(along), moment = -c * 0.25 * half * half * half * squared(turn);
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      for (const double node : {kNodes[i], -kNodes[i]}) {
        const double drag = kShares[i] * (c + f * node) * squared(along + half * node * turn);
        force += drag;
        moment += half * node * drag;
      }
    }
    load.wrench[across_] -= force;
    load.wrench[turning()] -= side * moment;
  }

 private:
  static constexpr double kOrdinary = 1.2;  // m, of a craft of 30 kg
  [[nodiscard]] Eigen::Index turning() const { return across_ == 1 ? 5 : 4; }
  [[nodiscard]] static double length(const Vehicle& vehicle) {
    return vehicle.hull.x() > 0.0 ? vehicle.hull.x() : kOrdinary * size_factor(vehicle, "m");
  }

  Eigen::Index across_;
  bool stated_;
  const char* name_;
};

}  // namespace

const Effect& cross_flow() {
  static const Effect kEffect{
      {.name = "cross_flow",
       .sentence = "Where the hull drifts and turns at once, each part of it is dragged by its own speed across.",
       .revealed_by = "drifting and turning at once, one way and the other, and each alone",
       .stage = Stage::kBody,
       .amplitudes = 2,
       .forms_coexist = true,
       .feels_motion = false,
       .asked_first = true,
       .own_flow = true},
      kCrossFlowParameters,
      forms(Strips{1, true, "sideways"}, Strips{2, true, "up and down"}, Strips{1, false, "sideways, of a length"},
            Strips{2, false, "up and down, of a length"})};
  return kEffect;
}

}  // namespace fathom::model::effects
