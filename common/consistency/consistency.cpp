#include "common/consistency/consistency.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/units.hpp"
#include "common/consistency/consistency_check.hpp"
#include "common/consistency/increments/increment_estimate.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kWorkingRate =
    25.0;  // Hz: faster streams are averaged; a 40 ms mean takes 0.3 % off at 1 Hz, off both sides

constexpr double kSettled = 0.001;  // s: a delay that is measured no better
constexpr double kTogether = 0.5;   // of a delay: two sensors whose own delay is surely below this share go together

}  // namespace

Check::Check(std::span<const Recording> recordings) {
  result_.corrections.resize(recordings.size());
  one_estimate_ = std::ranges::all_of(recordings, &Recording::one_estimate);
  for (const Recording& recording : recordings) {
    runs_.push_back(read_signals(recording, result_.findings));
    const RunSignals& run = runs_.back();
    names_.push_back(run.name);
    poses_.push_back(block_average(reference_pose(run), kWorkingRate));
    gyro_.push_back(block_average(run.gyro, kWorkingRate));
    dvl_.push_back(recording.one_estimate ? Series{} : block_average(run.dvl, kWorkingRate));
    force_.push_back(block_average(run.specific_force, kWorkingRate));
    reference_ = run.pose.has_attitude || run.attitude.empty() ? "pose_capture" : "ahrs_attitude";
  }
}

PairResult Check::rates() const {
  std::vector<IncrementFit> fits(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_attitude || gyro_[r].empty()) continue;
    fits[r] = fit_increments(rate_problem(pose(r)), gyro_[r], {.outlier_floor = 1.5 * kDegree});
  }
  const PairNames names{
      .signal = "gyro", .reference = reference_, .axes = {"p", "q", "r"}, .unit = "rad/s", .bias_floor = 2e-4};
  return compare(names, names_, std::move(fits));
}

PairResult Check::velocity(const PairResult& gyro) const {
  std::vector<IncrementFit> fits(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || dvl_[r].empty()) continue;
    const bool with_rates = gyro.checked && gyro.explained > 0.8 && !gyro_[r].empty();
    const Series rates = with_rates ? on_reference_clock(gyro.faults[r], gyro_[r]) : Series{};
    fits[r] =
        fit_increments(velocity_problem(pose(r), with_rates ? &rates : nullptr), dvl_[r], {.outlier_floor = 0.03});
  }
  const PairNames names{
      .signal = "dvl", .reference = "pose_capture", .axes = {"u", "v", "w"}, .unit = "m/s", .bias_floor = 2e-3};
  return compare(names, names_, std::move(fits));
}

PairResult Check::acceleration() const {
  std::vector<IncrementFit> fits(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || force_[r].empty()) continue;
    fits[r] = fit_increments(acceleration_problem(pose(r)), force_[r], {.outlier_floor = 0.3});
  }
  const PairNames names{.signal = "accelerometer",
                        .reference = "pose_capture",
                        .axes = {"x", "y", "z"},
                        .unit = "m/s^2",
                        .bias_floor = 0.03,
                        .has_bias = false};
  return compare(names, names_, std::move(fits));
}

/// Clocks by majority, and nothing is measured before it happens: where gyro and attitude go together and the velocity
/// log seems early against the position, it is the position alone that comes late.
bool Check::blame_late_position(const PairResult& gyro, const PairResult& dvl) {
  if (!gyro.checked || !dvl.checked) return false;
  bool any = false;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    // Once begun, what is left is taken too, however small: turning while late bends the first answer.
    const bool begun = result_.corrections[r].position_late != 0.0;
    const double delay = begun && dvl.fits[r].ok ? dvl.fits[r].delay : dvl.faults[r].delay;
    if (begun ? std::abs(delay) < kSettled : !(delay < 0.0)) continue;
    if (!gyro.fits[r].ok || gyro.faults[r].delay != 0.0) continue;
    const Estimate together = estimate_delay(gyro.fits[r]);
    if (std::abs(together.value) + 2.0 * together.sigma >
        kTogether * std::max(std::abs(delay), result_.corrections[r].position_late))
      continue;
    result_.corrections[r].position_late -= delay;
    any = true;
  }
  if (!any) return false;
  std::erase_if(result_.findings, [](const ConsistencyFinding& one) {
    return one.signal == "pose_capture.position" && one.finding == "delay";
  });
  const auto all_alike = [&] {
    return std::ranges::all_of(result_.corrections, [&](const Corrections& one) {
      return one.position_late == result_.corrections.front().position_late;
    });
  }();
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const double late = result_.corrections[r].position_late;
    if (late == 0.0 || (all_alike && r > 0)) continue;
    const Estimate known = estimate_delay(dvl.fits[r]);
    result_.findings.push_back(
        {.run = all_alike ? "all" : names_[r],
         .signal = "pose_capture.position",
         .reference = "dvl and gyro",
         .finding = "delay",
         .size = late,
         .unit = "s",
         .evidence =
             text("the position comes %.3f +- %.3f s late: the velocity log seems early by that, attitude and rates "
                  "go together, and nothing is measured before it happens",
                  late, known.sigma),
         .action = "corrected: each attitude gets the position that was logged so much later; all other stamps stay",
         .std = known.sigma,
         .freedom = known.freedom});
  }
  return true;
}

void Check::align_clocks(bool dvl_compared, bool gyro_compared) {
  bool gyro_apart = false, dvl_apart = false;
  for (const Corrections& one : result_.corrections) {
    gyro_apart = gyro_apart || one.gyro.delay != 0.0;
    dvl_apart = dvl_apart || one.dvl.delay != 0.0;
  }
  // Two that agree outvote the third; where all differ, the gyro is taken to be on board with the thrusters.
  const bool gyro_alone = gyro_apart && dvl_compared && !dvl_apart;
  // Without a gyro to say more: a velocity log that seems early is on time, and the pose late.
  bool pose_late = !gyro_compared && dvl_apart;
  for (const Corrections& one : result_.corrections) pose_late = pose_late && one.dvl.delay <= 0.0;
  for (Corrections& one : result_.corrections) {
    const double base = gyro_alone ? 0.0 : pose_late ? one.dvl.delay : one.gyro.delay;
    one.pose_shift = base;  // gyro(t + delay) belongs to pose(t): the pose's stamps move to the gyro's clock
    one.gyro_shift = base - one.gyro.delay;
    one.dvl_shift = base - one.dvl.delay;
  }
  if (!gyro_apart && !dvl_apart) return;
  const bool on_gyro = gyro_apart && !gyro_alone;
  report(
      "thrusters", "clock", result_.corrections[0].pose_shift, "s",
      std::string("the clocks differ; kinematics cannot tell on whose clock the thrusters are: taken to be that of ") +
          (on_gyro      ? "the on-board gyro"
           : gyro_alone ? "the pose, with which the velocity log agrees"
           : pose_late  ? "the velocity log, for nothing is measured before it happens: the pose is late"
                        : "the pose"),
      on_gyro     ? "assumed: thruster stamps unshifted; pose stamps moved by the size"
      : pose_late ? "assumed: thruster stamps unshifted; pose stamps moved by the size"
                  : "assumed: thruster and pose stamps unshifted",
      on_gyro ? "gyro" : reference_);
}

void Check::report_outliers(const std::string& name, const PairResult& pair) {
  for (std::size_t r = 0; r < pair.fits.size(); ++r) {
    const auto count = pair.fits[r].outlier_times.size();
    if (!pair.checked || count == 0) continue;
    result_.findings.push_back(
        {.run = names_[r],
         .signal = name,
         .reference = reference_,
         .finding = "outliers",
         .size = static_cast<double>(count),
         .unit = "windows",
         .evidence = std::to_string(count) +
                     " of the windows of about 1 s miss by more than 8 robust sigmas, the first at " +
                     text("%.1f s", pair.fits[r].outlier_times.front()),
         .action = name == "gyro" ? "pose masked there, gyro trusted" : "given no weight in the comparison"});
  }
}

ConsistencyResult Check::run() {
  choose_readings();
  PairResult gyro = rates();
  PairResult dvl = velocity(gyro);
  if (blame_position_unit(dvl)) dvl = velocity(gyro);
  for (int round = 0; round < 3 && find_heading(dvl); ++round) dvl = velocity(gyro);
  if (blame_pose_tilt(gyro, dvl)) {
    gyro = rates();
    dvl = velocity(gyro);
  }
  if (blame_position_scale(dvl)) dvl = velocity(gyro);
  for (int round = 0; round < 4 && blame_late_position(gyro, dvl); ++round) dvl = velocity(gyro);
  compare_distances(dvl);
  PairResult force = acceleration();
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (gyro.checked) {
      result_.corrections[r].gyro = gyro.faults[r];
      result_.corrections[r].doubtful_pose = gyro.fits[r].outlier_times;
    }
    if (dvl.checked) result_.corrections[r].dvl = dvl.faults[r];
    if (force.checked) result_.corrections[r].accelerometer = force.faults[r];
  }
  const auto append = [&](const std::vector<ConsistencyFinding>& findings) {
    result_.findings.insert(result_.findings.end(), findings.begin(), findings.end());
  };
  for (const auto& [name, pair] :
       {std::pair<std::string, PairResult*>{"gyro", &gyro}, {"dvl", &dvl}, {"accelerometer", &force}}) {
    append(pair->findings);
    report_outliers(name, *pair);
  }
  for (std::size_t r = 0; r < runs_.size(); ++r) append(compare_depth(runs_[r], pose(r)));
  std::vector<PoseSeries> poses;
  for (std::size_t r = 0; r < runs_.size(); ++r) poses.push_back(pose(r));
  append(compare_with_vertical(reference_ + ".attitude", names_, poses));
  align_clocks(dvl.checked || one_estimate_, gyro.checked);
  append(compare_noise(runs_));
  result_.pairs.emplace("gyro", std::move(gyro));
  result_.pairs.emplace("dvl", std::move(dvl));
  result_.pairs.emplace("accelerometer", std::move(force));
  return std::move(result_);
}

Series on_reference_clock(const SensorFault& fault, const Series& logged) {
  Series corrected = logged;
  const Eigen::Matrix3d M = fault.matrix();
  for (double& t : corrected.t) t -= fault.delay;
  for (Eigen::Vector3d& x : corrected.x) x = M * x + fault.bias;
  return corrected;
}

ConsistencyResult check_consistency(std::span<const Recording> recordings) { return Check(recordings).run(); }

}  // namespace fathom::consistency
