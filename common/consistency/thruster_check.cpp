// The wrench that was computed on board against the one that the vehicle file makes of the same commands and voltage.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/base/factors.hpp"
#include "common/base/statistics.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/estimation/wording.hpp"
#include "common/model/actuators.hpp"

namespace fathom::consistency {

using estimation::forces_of;
using estimation::reference_voltage;
using estimation::voltage_at;

namespace {

constexpr double kAgrees = 0.95;         // R^2: below, the vehicle's curve is not the one that was used on board
constexpr double kExponentFloor = 0.15;  // of the voltage; less moves the thrust by under 2 % over 12 to 13.5 V
constexpr double kScaleFloor = 0.02;
constexpr double kSignificant = 4.0;    // standard errors
constexpr double kVoltageMoves = 1.05;  // a voltage that moves less shows no exponent
constexpr double kLargestExponent = 2.5;
constexpr std::size_t kBlocks = 10;

/// Weighted regression of log ratio on log voltage.
struct Sums {
  double one{}, x{}, y{}, xx{}, xy{};

  Sums& operator+=(const Sums& other) {
    one += other.one;
    x += other.x;
    y += other.y;
    xx += other.xx;
    xy += other.xy;
    return *this;
  }
  [[nodiscard]] double slope() const {
    const double spread = xx - x * x / one;
    return spread > 0.0 ? (xy - x * y / one) / spread : 0.0;
  }
  [[nodiscard]] double level(double slope) const { return (y - slope * x) / one; }
};

/// A value and its standard error by leaving out one block at a time.
struct Estimated {
  double value{}, error{};
  [[nodiscard]] bool exceeds(double floor) const { return std::abs(value) > std::max(floor, kSignificant * error); }
};

template <class Statistic>
Estimated jackknifed(const std::array<Sums, kBlocks>& blocks, Statistic statistic) {
  Sums all;
  for (const Sums& block : blocks) all += block;
  Estimated result{.value = statistic(all)};
  std::array<double, kBlocks> replicates{};
  for (std::size_t out = 0; out < kBlocks; ++out) {
    Sums rest;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      if (b != out) rest += blocks[b];
    }
    replicates[out] = rest.one > 0.0 ? statistic(rest) : result.value;
  }
  result.error = jackknife_sigma(replicates);
  return result;
}

/// Forces of the commands of each sample that has the logged wrench too.
template <class Use>
void each_pair(std::span<const Recording> recordings, const model::Vehicle& vehicle, const Use& use) {
  const double reference = reference_voltage(vehicle);
  for (const Recording& recording : recordings) {
    for (const Thrusters& sample : recording.thrusters) {
      if (!sample.has_tau || sample.pwm_us.size() != vehicle.thrusters.size()) continue;
      const double battery = voltage_at(recording.battery, sample.utime);
      const std::vector<double> force =
          forces_of(ThrusterCorrection{}, vehicle, sample.pwm_us, battery > 0.0 ? battery : reference);
      use(Eigen::Map<const Vector6d>(sample.tau.data()),
          Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size())), battery);
    }
  }
}

/// Thrusters that push the other way than the file says, by least squares of the logged wrench on each one's share of
/// the computed; empty where turning them round does not make the two agree.
std::string reversed_thrusters(std::span<const Recording> recordings, const model::Vehicle& vehicle,
                               const Vector6d& weight) {
  constexpr double kRidge = 1e-6;  // relative: thrusters that are always commanded alike share what they did
  const Eigen::Index n = vehicle.allocation.cols();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  double total = 0.0;
  const Eigen::MatrixXd allocation = weight.asDiagonal() * vehicle.allocation;
  each_pair(recordings, vehicle, [&](const Vector6d& tau, const Eigen::VectorXd& force, double) {
    const Eigen::MatrixXd shares = allocation * force.asDiagonal();
    const Vector6d wanted = weight.cwiseProduct(tau);
    normal += shares.transpose() * shares;
    right += shares.transpose() * wanted;
    total += wanted.squaredNorm();
  });
  const Eigen::MatrixXd held = normal + kRidge * normal.trace() * Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd gains = solve_symmetric(held, right);
  Eigen::VectorXd sign = Eigen::VectorXd::Ones(n);
  std::string names;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (gains[i] > -0.5) continue;
    sign[i] = -1.0;
    names += (names.empty() ? "" : ", ") + vehicle.thrusters[static_cast<std::size_t>(i)].name;
  }
  const double misfit = total - 2.0 * sign.dot(right) + sign.dot(normal * sign);
  return misfit < (1.0 - kAgrees) * total ? names : std::string{};
}

}  // namespace

void check_thrusters(std::span<const Recording> recordings, const model::Vehicle& vehicle, ConsistencyResult& result) {
  const auto thrusters = vehicle.thrusters.size();
  bool has_tau = false, has_commands = false, has_force = false;
  for (const Recording& recording : recordings) {
    for (const Thrusters& sample : recording.thrusters) {
      has_tau = has_tau || sample.has_tau;
      has_commands = has_commands || (sample.pwm_us.size() == thrusters && thrusters > 0);
      has_force = has_force || !sample.force.empty();
    }
  }
  const bool can_compute = has_commands && model::takes_commands(vehicle) &&
                           vehicle.allocation.cols() == static_cast<Eigen::Index>(thrusters);
  if (!can_compute || has_force) return;
  const auto decide = [&](const ThrusterCorrection& correction) {
    for (Corrections& one : result.corrections) one.thrusters = correction;
  };
  if (!has_tau) return decide({.use_commands = true, .scale = 1.0, .exponent = 0.0});

  const double reference = reference_voltage(vehicle);
  struct Pair {
    Vector6d tau, computed;
    double log_voltage;
  };
  std::vector<Pair> pairs;
  double low = 1e9, high = 0.0;  // V
  Vector6d size = Vector6d::Zero();
  each_pair(recordings, vehicle, [&](const Vector6d& tau, const Eigen::VectorXd& force, double battery) {
    pairs.push_back({tau, vehicle.allocation * force, battery > 0.0 ? std::log(battery / reference) : 0.0});
    size += tau.cwiseAbs2();
    if (battery > 0.0) {
      low = std::min(low, battery);
      high = std::max(high, battery);
    }
  });
  if (pairs.empty()) return;
  const Vector6d weight = (size / static_cast<double>(pairs.size())).cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  std::array<Sums, kBlocks> blocks;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Vector6d a = weight.cwiseProduct(pairs[i].computed), b = weight.cwiseProduct(pairs[i].tau);
    const double energy = a.squaredNorm();
    if (energy < 1.0 || a.dot(b) <= 0.05 * energy) continue;  // near the dead band the ratio is noise
    const double y = std::log(a.dot(b) / energy), x = pairs[i].log_voltage;
    blocks[i * kBlocks / pairs.size()] += {energy, energy * x, energy * y, energy * x * x, energy * x * y};
  }
  ThrusterCorrection correction;
  Sums sums;
  for (const Sums& block : blocks) sums += block;
  Estimated exponent_change, scale_change;
  if (sums.one > 0.0) {
    if (high > kVoltageMoves * low) exponent_change = jackknifed(blocks, [](const Sums& part) { return part.slope(); });
    // Thrust falls with the voltage at most as its square; another exponent is an error of the curve in disguise.
    const double whole = vehicle.curve.voltage_exponent + exponent_change.value;
    if (exponent_change.exceeds(kExponentFloor) && whole > 0.0 && whole < kLargestExponent) {
      correction.exponent = exponent_change.value;
    }
    scale_change = jackknifed(blocks, [&](const Sums& part) { return std::expm1(part.level(correction.exponent)); });
    if (scale_change.exceeds(kScaleFloor)) correction.scale = 1.0 + scale_change.value;
  }
  double misfit = 0.0, total = 0.0;
  for (const Pair& pair : pairs) {
    const double factor = correction.scale * std::exp(correction.exponent * pair.log_voltage);
    misfit += weight.cwiseProduct(pair.tau - factor * pair.computed).squaredNorm();
    total += weight.cwiseProduct(pair.tau).squaredNorm();
  }
  const double explained = 1.0 - misfit / total;
  correction.use_commands = explained > kAgrees;
  const auto report = [&](const std::string& finding, double value, const std::string& evidence,
                          const std::string& action) {
    result.findings.push_back({.run = "all",
                               .signal = "thrusters.tau",
                               .reference = "thrusters.pwm",
                               .finding = finding,
                               .size = value,
                               .unit = "",
                               .evidence = evidence,
                               .action = action});
  };
  const std::string action = correction.use_commands
                                 ? "thruster forces from the commands, scaled to give the logged wrench"
                                 : "the logged wrench is used";
  const std::string reversed = correction.use_commands ? "" : reversed_thrusters(recordings, vehicle, weight);
  if (!reversed.empty()) {
    report("sign", -1.0,
           text("the vehicle's curve and allocation explain %.3f of the logged wrench, and all but %.2f of it with ",
                explained, 1.0 - kAgrees) +
               reversed + " reversed",
           action + "; turn the axis, or set pwm_sign: -1, of " + reversed + " in the vehicle file");
  } else if (!correction.use_commands) {
    report("disagreement", explained,
           text("the vehicle's curve and allocation explain %.3f of the logged wrench, %.2f is needed", explained,
                kAgrees),
           action);
  } else {
    const double exponent = correction.exponent + vehicle.curve.voltage_exponent;
    if (std::abs(exponent) > kExponentFloor && high > kVoltageMoves * low) {
      report("voltage", exponent,
             text("grows as (V/%.3g V)^%.2f between %.1f and %.1f V: the logged wrench contains the voltage already "
                  "(R^2 %.3f)",
                  reference, exponent, low, high, explained),
             action);
    }
    if (correction.scale != 1.0) {
      report("scale", correction.scale,
             text("the logged wrench is %.3f +- %.3f times the computed one (R^2 %.3f)", correction.scale,
                  scale_change.error, explained),
             action);
    }
  }
  decide(correction);
}

}  // namespace fathom::consistency
