// The wrench that was computed on board against the one that the vehicle file makes of the same commands and voltage.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/estimation/consistency.hpp"

namespace fathom::estimation {
namespace {

constexpr double kAgrees = 0.95;         // R^2: below, the vehicle's curve is not the one that was used on board
constexpr double kExponentFloor = 0.15;  // of the voltage; less moves the thrust by under 2 % over 12 to 13.5 V
constexpr double kScaleFloor = 0.02;

double voltage_at(const std::vector<Battery>& battery, Utime utime) {
  if (battery.empty()) return 0.0;
  const auto after =
      std::lower_bound(battery.begin(), battery.end(), utime, [](const Battery& b, Utime t) { return b.utime < t; });
  if (after == battery.begin()) return after->voltage;
  if (after == battery.end()) return battery.back().voltage;
  const auto before = after - 1;
  const double share = static_cast<double>(utime - before->utime) / static_cast<double>(after->utime - before->utime);
  return before->voltage + share * (after->voltage - before->voltage);
}

struct Sums {
  double one{}, x{}, y{}, xx{}, xy{};  // weighted regression of log ratio on log voltage
  double low{1e9}, high{0.0};          // V
};

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
  const bool can_compute =
      has_commands && !vehicle.curve.empty() && vehicle.allocation.cols() == static_cast<Eigen::Index>(thrusters);
  if (!can_compute || has_force) return;
  const auto decide = [&](const ThrusterCorrection& correction) {
    for (Corrections& one : result.corrections) one.thrusters = correction;
  };
  if (!has_tau) return decide({.use_commands = true, .scale = 1.0, .exponent = 0.0});

  const double reference = vehicle.curve.voltage > 0.0 ? vehicle.curve.voltage : std::max(vehicle.nominal_voltage, 1.0);
  struct Pair {
    Vector6d tau, computed;
    double log_voltage;
  };
  std::vector<Pair> pairs;
  Sums sums;
  Vector6d size = Vector6d::Zero();
  for (const Recording& recording : recordings) {
    for (const Thrusters& sample : recording.thrusters) {
      if (!sample.has_tau || sample.pwm_us.size() != thrusters) continue;
      const double battery = voltage_at(recording.battery, sample.utime);
      Eigen::VectorXd force(static_cast<Eigen::Index>(thrusters));
      for (std::size_t k = 0; k < thrusters; ++k) {
        force[static_cast<Eigen::Index>(k)] = vehicle.curve.force_at(sample.pwm_us[k], vehicle.thrusters[k].pwm_sign,
                                                                     battery > 0.0 ? battery : reference);
      }
      pairs.push_back({Eigen::Map<const Vector6d>(sample.tau.data()), vehicle.allocation * force,
                       battery > 0.0 ? std::log(battery / reference) : 0.0});
      size += pairs.back().tau.cwiseAbs2();
      if (battery > 0.0) {
        sums.low = std::min(sums.low, battery);
        sums.high = std::max(sums.high, battery);
      }
    }
  }
  if (pairs.empty()) return;
  const Vector6d weight = (size / static_cast<double>(pairs.size())).cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  for (const Pair& pair : pairs) {
    const Vector6d a = weight.cwiseProduct(pair.computed), b = weight.cwiseProduct(pair.tau);
    const double energy = a.squaredNorm();
    if (energy < 1.0 || a.dot(b) <= 0.05 * energy) continue;  // near the dead band the ratio is noise
    const double y = std::log(a.dot(b) / energy), x = pair.log_voltage;
    sums.one += energy;
    sums.x += energy * x;
    sums.y += energy * y;
    sums.xx += energy * x * x;
    sums.xy += energy * x * y;
  }
  ThrusterCorrection correction;
  if (sums.one > 0.0) {
    const double spread = sums.xx - sums.x * sums.x / sums.one;
    // A voltage that hardly moves (3 %) shows no exponent.
    if (sums.high > 1.03 * sums.low && spread > 0.0)
      correction.exponent = (sums.xy - sums.x * sums.y / sums.one) / spread;
    correction.scale = std::exp((sums.y - correction.exponent * sums.x) / sums.one);
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
  char evidence[200];
  const std::string action = correction.use_commands
                                 ? "thruster forces from the commands, scaled to give the logged wrench"
                                 : "the logged wrench is used";
  if (!correction.use_commands) {
    std::snprintf(evidence, sizeof evidence,
                  "the vehicle's curve and allocation explain %.3f of the logged wrench, %.2f is needed", explained,
                  kAgrees);
    report("disagreement", explained, evidence, action);
  } else {
    const double exponent = correction.exponent + vehicle.curve.voltage_exponent;
    if (std::abs(exponent) > kExponentFloor) {
      std::snprintf(
          evidence, sizeof evidence,
          "grows as (V/%.3g V)^%.2f between %.1f and %.1f V: the logged wrench contains the voltage already (R^2 %.3f)",
          reference, exponent, sums.low, sums.high, explained);
      report("voltage", exponent, evidence, action);
    }
    if (std::abs(correction.scale - 1.0) > kScaleFloor) {
      std::snprintf(evidence, sizeof evidence, "the logged wrench is %.3f times the computed one (R^2 %.3f)",
                    correction.scale, explained);
      report("scale", correction.scale, evidence, action);
    } else {
      correction.scale = 1.0;
    }
  }
  if (std::abs(correction.exponent) < kExponentFloor) correction.exponent = 0.0;
  decide(correction);
}

}  // namespace fathom::estimation
