// What adds to the sensor: biases, the share of the rates at a lever arm, and couplings that no lever arm can make.
#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/consistency/pairs/pair_comparison.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kLeverFloor = 0.005;    // m: smaller disagreements do not change a fitted model
constexpr double kPracticalLever = 0.1;  // m: 3 cm/s at 20 deg/s
constexpr double kPracticalBias = 20.0;  // floors
constexpr double kBadlyKnown = 100.0;    // floors
constexpr double kCouplingSeen = 4.0;    // sigmas

}  // namespace

void Comparison::find_offsets() {
  const int lever = names_.has_bias ? 12 : 9;
  for (int a = 0; a < 3 && names_.has_bias; ++a) {
    std::vector<Estimate> estimates(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!fit(r).ok || fit(r).explained < kLeastExplained) continue;
      estimates[r] = estimate(
          fit(r), [&](const Eigen::VectorXd& theta) { return theta[9 + a]; }, false);
      // A bias that is known badly can be large all the same, but only where the axis by itself is seen: at one rate
      // throughout, noise takes the slope away and the bias takes its place.
      const bool seen = seen_[r][static_cast<std::size_t>(a)];
      estimates[r].informative = estimates[r].sigma < 10.0 * names_.bias_floor ||
                                 (seen && estimates[r].sigma < kBadlyKnown * names_.bias_floor);
    }
    const SharedValue decision = share(estimates, 0.0, names_.bias_floor);
    report(decision, axis(a), "bias", names_.unit, 0.0, kPracticalBias * names_.bias_floor,
           "corrected: the size is added");
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].bias[a] = decision.applied[r];
  }
  const auto columns = [&](std::size_t r) { return static_cast<int>(fit(r).theta.size()); };
  const auto offsets = [&](int column, double floor, double limit, int lever_axis = -1) {
    std::vector<Estimate> estimates(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!fit(r).ok || fit(r).explained < kLeastExplained || column >= columns(r)) continue;
      if (lever_axis >= 0 && !fit(r).lever_seen[lever_axis]) continue;
      // What the sensor's noise takes off its scale, the arm takes on: both are bracketed alike.
      estimates[r] = estimate(
          fit(r), [&](const Eigen::VectorXd& theta) { return theta[column]; }, lever_axis >= 0);
      estimates[r].informative = estimates[r].sigma < limit;
    }
    return share(estimates, 0.0, floor);
  };
  std::array<SharedValue, 3> levers;
  double largest_lever = 0.0;
  for (int a = 0; a < 3; ++a) {
    levers[static_cast<std::size_t>(a)] = offsets(lever + a, kLeverFloor, 0.05, a);
    if (levers[static_cast<std::size_t>(a)].found)
      largest_lever = std::max(largest_lever, std::abs(levers[static_cast<std::size_t>(a)].pooled.value));
  }
  // A lever arm makes an antisymmetric coupling to the rates and nothing else.
  double largest_coupling = 0.0;
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 6; ++k) {
    const SharedValue decision = offsets(lever + 4 + k, kLeverFloor, 0.02);
    const bool strong = decision.found && std::abs(decision.pooled.value) > kCouplingSeen * decision.pooled.sigma;
    if (!strong) continue;
    largest_coupling = std::max(largest_coupling, std::abs(decision.pooled.value));
    const auto [a, b] = kSymmetric[static_cast<std::size_t>(k)];
    coupling(a, b) = coupling(b, a) = decision.pooled.value;
  }
  std::string unknown;
  for (int a = 0; a < 3; ++a) {
    bool seen = false;
    for (std::size_t r = 0; r < runs_.size(); ++r) seen = seen || (fit(r).ok && fit(r).lever_seen[a]);
    if (!seen)
      unknown +=
          std::string(unknown.empty() ? "; unknown, for the vehicle hardly turned across it: " : ", ") + "xyz"[a];
  }
  const bool rigid = largest_coupling < 0.2 * largest_lever || largest_coupling == 0.0;
  static constexpr std::array<const char*, 3> kAxis{"x", "y", "z"};
  for (int a = 0; a < 3; ++a) {
    const SharedValue& decision = levers[static_cast<std::size_t>(a)];
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].lever[a] = decision.applied[r];
    const auto has_arm = [&](const IncrementFit& one) { return one.ok && lever + a < one.theta.size(); };
    if (rigid && std::ranges::any_of(result_.fits, has_arm)) {  // rates have no lever arm
      report(decision, names_.signal, std::string("lever_arm_") + kAxis[static_cast<std::size_t>(a)], "m", 0.0,
             kPracticalLever, "corrected: moved to the body origin", unknown);
    }
  }
  if (!rigid) {
    Eigen::Matrix3d whole = coupling;
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].coupling = coupling;
    whole += skew(result_.faults.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : result_.faults[0].lever);
    int row = 0, column = 0;
    whole.cwiseAbs().maxCoeff(&row, &column);
    result_.findings.push_back({.run = "all",
                                .signal = names_.signal,
                                .reference = names_.reference,
                                .finding = "rate_coupling",
                                .size = whole(row, column),
                                .unit = "m",
                                .evidence = "couples to the rates as no lever arm can (symmetric part up to " +
                                            text("%.1f mm", 1e3 * largest_coupling) +
                                            "): as if a lever correction had been made with wrong rates; largest: " +
                                            names_.axes[static_cast<std::size_t>(row)] + " from rate " +
                                            kAxis[static_cast<std::size_t>(column)],
                                .action = "corrected: the fitted coupling is taken out"});
  }
}

}  // namespace fathom::consistency
