// The section `supervisor` of a pipeline; the fence from the site's walls and the vehicle's hull.
#include <algorithm>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/motions.hpp"
#include "common/excitation/preflight.hpp"
#include "common/excitation/supervisor.hpp"
#include "common/model/parameters.hpp"
#include "common/model/priors/expected_inertia.hpp"
#include "common/model/priors/wide_prior.hpp"
#include "common/model/site.hpp"

namespace fathom::excitation {
namespace {

int axis_of(const std::string& mode) {
  for (std::size_t i = 0; i < kMotionNames.size(); ++i) {
    if (mode == kMotionNames[i]) return static_cast<int>(i);
  }
  return mode == "total" ? -1 : 6;
}

// A stated deceleration, or what the largest thrust on these axes gives the expected inertia, with something to spare.
double surely(double stated, const Vector6d& largest, const Vector6d& inertia, Eigen::Index first, Eigen::Index end) {
  constexpr double kSpare = 0.85;
  for (Eigen::Index i = first; i < end; ++i) {
    if (largest[i] > 0.0 && inertia[i] > 0.0) stated = std::min(stated, kSpare * largest[i] / inertia[i]);
  }
  return stated;
}

FenceSettings fence_from(const Config& config, const model::Vehicle& vehicle, const model::Site& site) {
  FenceSettings f;
  f.hard = config.positive("clearance", "m");
  f.band = config.positive("band", "m");
  f.braking = config.positive("braking", "m/s^2");
  f.turning = config.positive("turning", "rad/s^2");
  f.turns = config.positive("tether_turns", "");
  f.largest_speed = config.positive("largest_speed", "m/s");
  f.largest_rate = config.positive("largest_rate", "rad/s");
  f.largest_tilt = config.positive("largest_tilt", "rad");
  // The vehicle may point anywhere: a circle around its hull, and its height.
  const double across = 0.5 * vehicle.hull.head<2>().norm() + f.hard;
  const double up = 0.5 * vehicle.hull.z() + f.hard;
  f.half_length = 0.5 * vehicle.hull.head<2>().maxCoeff();
  f.low = {site.south + across, site.west + across, site.surface + up};
  f.high = {site.north - across, site.east - across, site.floor - up};
  f.waterline = site.surface;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (!(f.low[i] < f.high[i])) config.fail("clearance", "no room is left between the site's walls for this hull");
  }
  return f;
}

}  // namespace

SupervisorSettings SupervisorSettings::from(const Config& config, const model::Vehicle& vehicle,
                                            const model::Site& site) {
  SupervisorSettings s;
  s.seed = static_cast<std::uint64_t>(std::max(0, config.integer("seed")));
  s.optimal = config.either("excitation", "optimal", "paper");
  s.rate = config.positive("rate", "Hz");
  s.life = config.positive("life", "s");
  const Config largest = config.section("largest");
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string axis = model::kAxisNames[i];
    const bool rights_itself = i == 3 || i == 4;
    if ((rights_itself || !vehicle.dof[i]) && !largest.has(axis)) continue;
    const double value = largest.not_negative(axis, i < 3 ? "N" : "N m");
    if (vehicle.dof[i]) s.largest[static_cast<Eigen::Index>(i)] = value;
  }
  // P* is for the paper's vehicle: that of a heavier one has larger parameters, and larger noise of the forces.
  const Vector6d heavier = model::inertia_beside_lbv150(vehicle);
  const Config thresholds = config.section("thresholds");
  double paper = 0.0, here = 0.0;
  for (const std::string& mode : thresholds.keys()) {
    const int axis = axis_of(mode);
    if (axis < 0 || axis > 5) continue;
    const double share = thresholds.positive(mode, "");
    paper += share;
    here += share * heavier[axis] * heavier[axis];
  }
  for (const std::string& mode : s.optimal ? std::vector<std::string>{"total"} : config.texts("schedule")) {
    const int axis = axis_of(mode);
    if (axis > 5) config.fail("schedule", "no mode '" + mode + "'; known: surge, sway, heave, roll, pitch, yaw, total");
    const double larger = axis < 0 ? (paper > 0.0 ? here / paper : 1.0) : heavier[axis] * heavier[axis];
    s.schedule.push_back({.name = mode, .axis = axis, .threshold = larger * thresholds.positive(mode, "")});
  }
  if (s.optimal) (void)config.texts("schedule");
  for (const std::string& mode : thresholds.keys()) (void)thresholds.positive(mode, "");
  const Config signal = config.section("algorithm_1");
  s.low_share = signal.positive("low_share", "");
  s.highest_frequency = signal.positive("highest_frequency", "Hz");
  s.submode_time = signal.positive("submode_time", "s");
  s.interval_time = signal.positive("interval_time", "s");
  s.random_amplitude = signal.either("amplitude", "random", "largest");
  s.least_dwell = config.not_negative("least_dwell", "s");
  s.most_dwell = config.positive("most_dwell", "s");
  s.retries = config.integer("retries");
  s.approach_time = config.positive("approach_time", "s");
  s.closing_time = config.not_negative("closing_time", "s");
  s.patience = config.positive("patience", "s");
  if (config.has("model_patience")) s.model_patience = config.positive("model_patience", "s");
  if (config.has("flights")) s.flights = std::max(0, config.integer("flights"));
  s.order_age = config.positive("order_age", "s");
  if (config.has("manual_life")) s.manual_life = config.positive("manual_life", "s");
  if (config.has("operator_lost")) {
    const Config lost = config.section("operator_lost");
    s.holds_without_operator = lost.either("action", "hold", "abort");
    s.wants_operator = lost.either("required", "yes", "no");
  }
  s.open_range = config.positive("open_range", "m");
  s.needs = config.has("needs") ? config.texts("needs") : usual_needs();
  s.surface = site.surface + 0.5 * vehicle.hull.z();
  if (config.has("silence")) s.silence = config.positive("silence", "s");
  s.fence = fence_from(config.section("fence"), vehicle, site);
  const Vector6d expected = model::expected_inertia(vehicle);
  s.fence.braking = surely(s.fence.braking, s.largest, expected, 0, 3);
  s.fence.turning = surely(s.fence.turning, s.largest, expected, 5, 6);
  const Config hold = config.section("hold");
  s.hold.bandwidth = hold.positive("bandwidth", "rad/s");
  s.hold.damping = hold.positive("damping", "");
  s.hold.trim_time = hold.positive("trim_time", "s");
  s.hold.mass = std::max(1.2 * vehicle.mass, expected.head<3>().mean());
  s.hold.inertia = vehicle.mass > 0.0 ? model::wide_prior(model::BaseParameter::I_Z, vehicle).mean : expected[5];
  const Config leaving = config.section("leaving");
  s.leaving.largest_ratio = leaving.positive("largest_ratio", "");
  s.leaving.largest_mean = leaving.positive("largest_mean", "");
  s.leaving.lightest_share = leaving.positive("lightest_share", "");
  s.leaving.heaviest_share = leaving.positive("heaviest_share", "");
  s.leaving.ordinary_speed = leaving.positive("ordinary_speed", "");
  const Config design = config.section("design");
  s.design.criterion = design.either("criterion", "A", "D") ? Criterion::kA : Criterion::kD;
  s.design.duration = design.positive("duration", "s");
  s.design.draws = design.integer("draws");
  s.design.highest_frequency = design.positive("highest_frequency", "Hz");
  s.design.rows_per_second = design.positive("rows_per_second", "Hz");
  s.design.noise << Eigen::Vector3d::Constant(design.positive("noise_force", "N")),
      Eigen::Vector3d::Constant(design.positive("noise_moment", "N m"));
  s.design.noise.head<3>() = s.design.noise.head<3>().cwiseProduct(heavier.head<3>());
  return s;
}

}  // namespace fathom::excitation
