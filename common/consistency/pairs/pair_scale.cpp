// How much too large or small each logged axis reads, and whether that is a unit.
#include <array>
#include <cmath>

#include "common/consistency/pairs/pair_comparison.hpp"

namespace fathom::consistency {
namespace {

constexpr double kScaleFloor = 0.010;  // smaller disagreements do not change a fitted model

constexpr double kPractical = 0.05;  // bends masses and drag by as much

/// "cm/s read as m/s" where a scale is a unit.
std::string unit_guess(double scale, bool rates) {
  struct Unit {
    double factor;
    const char* words;
  };
  static constexpr std::array<Unit, 2> kAngles{{{0.0174533, "the logged numbers are degrees"},
                                                {57.29578, "the logged numbers were divided by 57.3 once too often"}}};
  static constexpr std::array<Unit, 6> kLengths{{{0.01, "the logged numbers are centimetres"},
                                                 {0.001, "the logged numbers are millimetres"},
                                                 {0.3048, "the logged numbers are feet"},
                                                 {100.0, "the reference is in centimetres"},
                                                 {1000.0, "the reference is in millimetres"},
                                                 {3.28084, "the reference is in feet"}}};
  const auto search = [&](const auto& list) -> std::string {
    for (const Unit& unit : list) {
      if (std::abs(scale / unit.factor - 1.0) < 0.1) return unit.words;
    }
    return "";
  };
  return rates ? search(kAngles) : search(kLengths);
}

}  // namespace

void Comparison::find_scales() {
  for (int k = 0; k < 3; ++k) {
    std::vector<Estimate> estimates(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!seen_[r][static_cast<std::size_t>(k)]) continue;
      const Eigen::Vector3d direction = turned_[r].col(k);
      estimates[r] = estimate(
          fit(r), [&](const Eigen::VectorXd& theta) { return direction.dot(theta.segment<3>(3 * k)); }, true);
    }
    const SharedValue decision = share(estimates, 1.0, kScaleFloor);
    const std::string unit = unit_guess(decision.pooled.value, names_.signal == "gyro");
    report(decision, axis(k), decision.found && !unit.empty() ? "unit" : "scale", "", 1.0, kPractical,
           "corrected: multiplied by the size", "; 1 % matters" + (unit.empty() ? "" : "; " + unit));
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].scale[k] = decision.applied[r];
  }
}

}  // namespace fathom::consistency
