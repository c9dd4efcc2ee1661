// Physics: a measured velocity is older than its time stamp says: nu_measured(t) = nu(t - T). Forms: the velocity log
// alone (u v w), the rates alone (p q r), or both. Cubic interpolation between samples; before the window's first
// sample a straight line goes on. Source: the definition of a latency. Ignores: jitter, and the age of the pose from
// which a prediction begins. Revealed by steps and reversals while turning. Confused with thruster_delay: "all" is the
// same thing seen from the other side (only their sum can be known) and not asked where poses were compared with both
// groups, one group alone is told apart by the other; with thruster_lag.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/effect.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kSensorLatencyParameters{
    EffectParameter{.name = "latency", .unit = "s", .sigma = 0.1, .low = 0.0, .high = 1.5, .after_command = true}};
using Sample = Eigen::Matrix<double, 6, 1>;

/// One step of a walk along the trace: writes sample k as it was `back` samples earlier (later when negative). `kept`
/// is the sample that the walk has just overwritten.
class Shift {
 public:
  Shift(VelocityView& nu, Eigen::Index first, Eigen::Index rows, double back)
      : nu_{nu}, back_{back}, first_{first}, rows_{rows} {}

  void run() {
    const Eigen::Index n = nu_.cols();
    if (n < 2 || back_ == 0.0) return;
    // From the far end, so that what is read has not been written yet, but for one sample that is kept.
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index k = back_ > 0.0 ? n - 1 - i : i;
      const Sample original = nu_.col(k);
      const Sample moved = at(static_cast<double>(k) - back_);
      nu_.col(k).segment(first_, rows_) = moved.segment(first_, rows_);
      overwritten_ = k;
      kept_ = original;
    }
  }

 private:
  [[nodiscard]] Sample sample(Eigen::Index k) const { return k == overwritten_ ? kept_ : Sample{nu_.col(k)}; }

  [[nodiscard]] Sample at(double position) const {
    const Eigen::Index last = nu_.cols() - 1;
    if (position <= 0.0) return sample(0) + position * (sample(1) - sample(0));
    if (position >= static_cast<double>(last)) {
      return sample(last) + (position - static_cast<double>(last)) * (sample(last) - sample(last - 1));
    }
    const auto k = static_cast<Eigen::Index>(position);
    const double s = position - static_cast<double>(k);
    Sample from = sample(k);
    const Sample to = sample(k + 1);
    const Sample step = to - from;
    if (s == 0.0) return from;
    // Hermite's cubic with central slopes, one-sided at the ends (where a neighbour is already overwritten, the same).
    const Sample slope_from = k > 0 && readable(k - 1) ? Sample{0.5 * (to - sample(k - 1))} : step;
    const Sample slope_to = k + 2 <= last && readable(k + 2) ? Sample{0.5 * (sample(k + 2) - from)} : step;
    return from + s * step + s * (1.0 - s) * ((1.0 - s) * (slope_from - step) - s * (slope_to - step));
  }
  /// Not overwritten, or kept.
  [[nodiscard]] bool readable(Eigen::Index k) const {
    if (overwritten_ < 0 || k == overwritten_) return true;
    return back_ > 0.0 ? k < overwritten_ : k > overwritten_;
  }

  VelocityView& nu_;
  double back_;
  Eigen::Index first_, rows_, overwritten_{-1};
  Sample kept_{Sample::Zero()};
};

/// A group of the velocities that comes late, between kinds of sensors that nothing else has compared.
class LateGroup final : public Form {
 public:
  enum class Checked { kBoth, kVelocity, kRates };  // by which poses can have shown it already
  LateGroup(const char* name, Checked checked, Eigen::Index first, Eigen::Index rows)
      : name_{name}, checked_{checked}, first_{first}, rows_{rows} {}

  FormName name(const Scene& scene) const override {
    if (checked_ == Checked::kBoth) {
      // What moves together with poses that were compared with it is not late alone: then the thrust is.
      return when(!(scene.velocity_checked() && scene.rates_checked()), name_);
    }
    const auto& dof = scene.vehicle->dof;
    const bool both = scene.velocity && scene.rates && (dof[0] || dof[1] || dof[2]) && (dof[3] || dof[4] || dof[5]);
    const bool checked = checked_ == Checked::kVelocity ? scene.velocity_checked() : scene.rates_checked();
    return when(both && !checked, name_);
  }
  Starts starts(const Scene&) const override { return {{0.05}, {0.2}, {0.5}}; }
  void measure(VelocityView& nu, double dt, EffectTheta theta) const override {
    Shift{nu, first_, rows_, theta[0] / dt}.run();
  }
  void unmeasure(VelocityView& nu, double dt, EffectTheta theta) const override {
    Shift{nu, first_, rows_, -theta[0] / dt}.run();
  }

 private:
  const char* name_;
  Checked checked_;
  Eigen::Index first_, rows_;  // of the velocities
};

}  // namespace

const Effect& sensor_latency() {
  using Checked = LateGroup::Checked;
  static const Effect kEffect{
      {.name = "sensor_latency",
       .sentence = "A measured velocity is older than its time stamp.",
       .revealed_by = "steps and reversals of thrust while turning",
       .finding = "{form} comes {delay late}",
       .stage = Stage::kSensor,
       .forms_coexist = true,
       .feels_motion = false},
      kSensorLatencyParameters,
      forms(LateGroup{"all", Checked::kBoth, 0, 6}, LateGroup{"velocity", Checked::kVelocity, 0, 3},
            LateGroup{"rates", Checked::kRates, 3, 3})};
  return kEffect;
}

}  // namespace fathom::model::effects
