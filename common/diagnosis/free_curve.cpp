#include "common/diagnosis/free_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/vehicle.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kReach = 2.5;          // RMS values of speed and thrust that a curve covers
constexpr double kSmallestRange = 0.1;  // m: less tells nothing about a place
constexpr std::array<const char*, FreeCurve::kKnots> kNames{"k0", "k1", "k2", "k3", "k4", "k5", "k6", "k7"};

constexpr std::size_t kKnots = FreeCurve::kKnots;

std::array<model::EffectParameter, kKnots> knots(int axis, double ordinary) {
  std::array<model::EffectParameter, kKnots> parameters;
  for (std::size_t i = 0; i < kKnots; ++i) parameters[i] = {kNames[i], axis < 3 ? "N" : "N m", ordinary};
  return parameters;
}

class Curve final : public model::Form {
 public:
  Curve(int axis, Quantity quantity, double low, double high, bool input_is_wrench)
      : axis_{axis}, quantity_{quantity}, low_{low}, high_{high}, input_is_wrench_{input_is_wrench} {}
  void load(const model::Motion& motion, model::EffectTheta theta, model::Load& load) const override {
    const bool around = quantity_ == Quantity::kHeading;
    const double share = std::clamp((value(motion) - low_) / (high_ - low_), 0.0, 1.0);
    const double place = share * static_cast<double>(around ? kKnots : kKnots - 1);
    const std::size_t left = std::min(static_cast<std::size_t>(place), around ? kKnots - 1 : kKnots - 2);
    const double part = place - static_cast<double>(left);
    load.wrench[axis_] += (1.0 - part) * theta[left] + part * theta[(left + 1) % kKnots];
  }

 private:
  [[nodiscard]] double value(const model::Motion& motion) const {
    switch (quantity_) {
      case Quantity::kDepth:
        return motion.p_WB.z();
      case Quantity::kNorth:
        return motion.p_WB.x();
      case Quantity::kEast:
        return motion.p_WB.y();
      case Quantity::kHeading:
        return std::atan2(motion.R_WB(1, 0), motion.R_WB(0, 0));
      case Quantity::kTime:
        return motion.t;
      case Quantity::kSpeed:
        return motion.nu[axis_];
      case Quantity::kThrust:
        return input_is_wrench_ ? motion.force[axis_] : motion.vehicle->allocation.row(axis_).dot(motion.force);
    }
    return 0.0;
  }

  int axis_;
  Quantity quantity_;
  double low_, high_;
  bool input_is_wrench_;
};

}  // namespace

FreeCurve::FreeCurve(int axis, Quantity quantity, double low, double high, double ordinary, bool input_is_wrench)
    : Effect{{.name = "free_curve",
              .sentence = "Something depends on a measured quantity.",
              .revealed_by = "motion that covers the quantity evenly",
              .knows_size = true,
              .feels_place = true},
             knots(axis, ordinary),
             model::forms(Curve{axis, quantity, low, high, input_is_wrench})},
      axis_{axis},
      quantity_{quantity} {}

const char* name_of(Quantity quantity) {
  constexpr std::array kWords{"depth", "place (north)", "place (east)", "heading", "time", "speed", "thrust"};
  return kWords[static_cast<std::size_t>(quantity)];
}

std::vector<std::unique_ptr<const FreeCurve>> free_curves(const model::Scene& scene) {
  std::vector<std::unique_ptr<const FreeCurve>> curves;
  for (int axis = 0; axis < 6; ++axis) {
    if (!scene.vehicle->dof[static_cast<std::size_t>(axis)] || scene.tau_rms[axis] <= 0.0) continue;
    const auto add = [&](Quantity quantity, double low, double high) {
      curves.push_back(
          std::make_unique<FreeCurve>(axis, quantity, low, high, scene.tau_rms[axis], scene.input_is_wrench));
    };
    const auto add_place = [&](Quantity quantity, Eigen::Index i) {
      if (scene.position && scene.p_high[i] - scene.p_low[i] > kSmallestRange)
        add(quantity, scene.p_low[i], scene.p_high[i]);
    };
    add_place(Quantity::kDepth, 2);
    add_place(Quantity::kNorth, 0);
    add_place(Quantity::kEast, 1);
    if (scene.attitude) add(Quantity::kHeading, -std::numbers::pi, std::numbers::pi);
    if (scene.t_high > scene.t_low) add(Quantity::kTime, scene.t_low, scene.t_high);
    if (scene.nu_rms[axis] > 0.0) add(Quantity::kSpeed, -kReach * scene.nu_rms[axis], kReach * scene.nu_rms[axis]);
    add(Quantity::kThrust, -kReach * scene.tau_rms[axis], kReach * scene.tau_rms[axis]);
  }
  return curves;
}

}  // namespace fathom::diagnosis
