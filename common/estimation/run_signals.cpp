#include "common/estimation/run_signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "common/base/statistics.hpp"
#include "common/base/units.hpp"
#include "common/estimation/freezes.hpp"
#include "common/estimation/held_values.hpp"
#include "common/estimation/spikes.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kUnitTolerance =
    1e-3;                         // of |q|: rounding to three digits passes, interpolation across a flip does not
constexpr double kLongGap = 0.5;  // s: shorter gaps are bridged without loss

std::string number(double value) { return text("%.3g", value); }

class Reader {
 public:
  Reader(const Recording& recording, std::vector<ConsistencyFinding>& findings)
      : recording_(recording), findings_(findings) {}
  RunSignals read();

 private:
  void report(const std::string& signal, const std::string& what, double size, const std::string& unit,
              const std::string& evidence, const std::string& action) {
    findings_.push_back({.run = recording_.name,
                         .signal = signal,
                         .reference = "itself",
                         .finding = what,
                         .size = size,
                         .unit = unit,
                         .evidence = evidence,
                         .action = action});
  }
  void report_held(const std::string& signal, std::size_t repeats, std::size_t samples) {
    const double share = static_cast<double>(repeats) / static_cast<double>(samples);
    report(signal, "held", share, "", number(100.0 * share) + " % of the samples repeat the one before",
           "repeats are not used");
  }
  /// Repeats would look like freezes, and the steps between them like glitches.
  template <class Samples>
  void drop_held(const std::string& signal, Samples& samples) {
    Samples fresh = without_held(samples);
    if (fresh.empty()) return;
    report_held(signal, samples.size() - fresh.size(), samples.size());
    samples = std::move(fresh);
  }
  void gaps(const std::string& signal, const std::vector<double>& t) {
    const double limit = std::max(kLongGap, 4.0 * typical_step(t));
    double longest = 0.0, lost = 0.0;
    int count = 0;
    for (std::size_t i = 1; i < t.size(); ++i) {
      const double gap = t[i] - t[i - 1];
      if (gap <= limit) continue;
      ++count;
      lost += gap;
      longest = std::max(longest, gap);
    }
    if (count > 0) {
      report(signal, "gap", longest, "s",
             std::to_string(count) + " gaps longer than " + number(limit) + " s, " + number(lost) +
                 " s in all, the longest " + number(longest) + " s",
             "not used inside the gaps");
    }
  }
  void read_pose(PoseSeries& pose);
  void clean(const std::string& signal, Series& series, double spike_floor, bool may_hold);
  [[nodiscard]] double seconds(Utime utime) const { return seconds_between(origin_, utime); }

  const Recording& recording_;
  std::vector<ConsistencyFinding>& findings_;
  Utime origin_{};
};

void Reader::read_pose(PoseSeries& pose) {
  std::vector<Eigen::Vector4d> q;
  int bent = 0;
  for (const PoseCapture& sample : recording_.pose_capture) {
    const double length = sample.q_WB.norm();
    const bool finite = sample.p_WB.allFinite() && std::isfinite(length);
    if (!finite || (!pose.t.empty() && seconds(sample.utime) <= pose.t.back())) continue;
    const bool unit = std::abs(length - 1.0) < kUnitTolerance;
    if (!unit && sample.valid) ++bent;
    pose.t.push_back(seconds(sample.utime));
    pose.p_WB.push_back(sample.p_WB);
    pose.q_WB.push_back(length > 1e-6 ? sample.q_WB.normalized() : Eigen::Quaterniond::Identity());
    pose.valid.push_back(sample.valid && unit ? 1 : 0);
  }
  if (pose.empty()) return;
  make_continuous(pose.q_WB);
  drop_held("pose_capture", pose);
  for (const Eigen::Quaterniond& one : pose.q_WB) q.push_back(one.coeffs());
  for (std::size_t i = 1; i < pose.size(); ++i) {
    pose.has_position = pose.has_position || pose.p_WB[i] != pose.p_WB[0];
    pose.has_attitude = pose.has_attitude || q[i] != q[0];
  }
  const double step = typical_step(pose.t);
  std::vector<std::uint8_t> bad(pose.size(), 0);
  for (std::size_t i = 0; i < pose.size(); ++i) bad[i] = pose.valid[i] == 0 ? 1 : 0;
  const std::vector<std::uint8_t> flagged = bad;
  int jumps = 0;
  const auto add = [&](const std::vector<std::uint8_t>& more, bool count) {
    for (std::size_t i = 0; i < bad.size(); ++i) {
      const bool near = flagged[i] || (i > 0 && flagged[i - 1]) || (i + 1 < bad.size() && flagged[i + 1]);
      if (more[i] && count && !near && !bad[i] && (i == 0 || !more[i - 1])) ++jumps;
      bad[i] = bad[i] | more[i];
    }
  };
  double longest = 0.0;
  if (pose.has_position) {
    add(freezes(pose.p_WB, 3, longest, step), false);
    add(spikes(pose.t, pose.p_WB, 0.02), true);
  }
  if (pose.has_attitude) {
    add(freezes(q, 3, longest, step), false);
    add(spikes(pose.t, q, 0.5 * kDegree), true);  // 1 degree: a quaternion moves by half the angle
  }
  if (bent > 0) {
    report("pose_capture.attitude", "glitch", bent, "samples",
           std::to_string(bent) + " quaternions are not of unit length (more than 0.1 % off)",
           "those samples are not used");
  }
  if (jumps > 0) {
    report("pose_capture", "glitch", jumps, "samples",
           std::to_string(jumps) + " unflagged leaps away from the neighbouring poses", "masked with their neighbours");
  }
  if (longest > kLongGap) {
    report("pose_capture", "frozen", longest, "s",
           "the pose repeats itself exactly for up to " + number(longest) + " s, then leaps", "not used while frozen");
  }
  // A glitch spreads: trackers filter, and flags come late.
  const auto pad = std::max<std::ptrdiff_t>(3, std::lround(0.1 / std::max(step, 1e-3)));
  const auto n = static_cast<std::ptrdiff_t>(bad.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    if (!bad[static_cast<std::size_t>(i)]) continue;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - pad); j <= std::min(n - 1, i + pad); ++j)
      pose.valid[static_cast<std::size_t>(j)] = 0;
  }
  std::vector<double> good;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (!bad[i]) good.push_back(pose.t[i]);
  }
  gaps("pose_capture", good);
}

void Reader::clean(const std::string& signal, Series& series, double spike_floor, bool may_hold) {
  if (series.size() < 20) return;
  if (may_hold) drop_held(signal, series);
  const double step = typical_step(series.t);
  const std::vector<std::size_t> length = repeat_lengths(series.x);
  std::size_t repeats = 0;
  for (std::size_t i = 1; i < series.size(); ++i)
    repeats += length[i] > 1 && length[i] <= 5 && series.x[i] == series.x[i - 1];
  std::vector<std::uint8_t> bad(series.size(), 0);
  double longest = 0.0;
  const auto least = std::max<std::size_t>(5, static_cast<std::size_t>(1.0 / step));
  std::vector<std::uint8_t> frozen = freezes(series.x, least, longest, step);
  if (longest > 0.0) {
    report(signal, "frozen", longest, "s",
           "all three axes repeat themselves exactly for up to " + number(longest) + " s, then leap",
           "not used while frozen");
  }
  for (int axis = 0; axis < 3; ++axis) {
    const FrozenAxis alone = frozen_axis(series, axis, frozen);
    if (alone.longest <= 0.0) continue;
    const char* letters = signal == "gyro" ? "pqr" : signal == "dvl" ? "uvw" : "xyz";
    report(signal + "." + letters[axis], "frozen", alone.longest, "s",
           "repeats itself exactly for " + number(alone.longest) + " s, from " + text("%.1f s", alone.begin) +
               ", while another axis moves",
           "none of the axes used while it does");
    for (std::size_t i = 0; i < frozen.size(); ++i) frozen[i] = frozen[i] | alone.samples[i];
  }
  if (may_hold && repeats > series.size() / 20) {
    report_held(signal, repeats, series.size());
    for (std::size_t i = 1; i < series.size(); ++i) bad[i] = series.x[i] == series.x[i - 1] ? 1 : 0;
  }
  const std::vector<std::uint8_t> spike = speed_spikes(series, spike_floor);
  int leaps = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (spike[i] && !frozen[i] && (i == 0 || !spike[i - 1])) ++leaps;
    bad[i] = bad[i] | frozen[i] | spike[i];
  }
  if (leaps > 0) {
    report(signal, "glitch", leaps, "samples", std::to_string(leaps) + " samples leap away from their neighbours",
           "not used");
  }
  Series kept;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (bad[i]) continue;
    kept.t.push_back(series.t[i]);
    kept.x.push_back(series.x[i]);
  }
  series = std::move(kept);
  gaps(signal, series.t);
}

RunSignals Reader::read() {
  RunSignals run;
  run.name = recording_.name;
  origin_ = first_stamp(recording_);
  run.origin = origin_;
  read_pose(run.pose);
  const auto push = [](Series& series, double t, const Eigen::Vector3d& x) {
    if (!x.allFinite() || (!series.empty() && t <= series.t.back())) return;
    series.t.push_back(t);
    series.x.push_back(x);
  };
  for (const Ahrs& sample : recording_.ahrs) {
    const double t = seconds(sample.utime);
    if (sample.has_rates) push(run.gyro, t, sample.w_WB_B);
    if (sample.has_specific_force) push(run.specific_force, t, sample.f_B);
    if (sample.has_attitude && std::abs(sample.q_WB.norm() - 1.0) < kUnitTolerance &&
        (run.attitude.empty() || t > run.attitude.t.back())) {
      run.attitude.t.push_back(t);
      run.attitude.p_WB.push_back(Eigen::Vector3d::Zero());
      run.attitude.q_WB.push_back(sample.q_WB.normalized());
      run.attitude.valid.push_back(1);
    }
  }
  make_continuous(run.attitude.q_WB);
  drop_held("ahrs_attitude", run.attitude);
  run.attitude.has_attitude = !run.attitude.empty();
  for (const Dvl& sample : recording_.dvl) {
    if (sample.valid && !sample.held) push(run.dvl, seconds(sample.utime), sample.v_WB_B);
  }
  for (const Depth& sample : recording_.depth) push(run.depth, seconds(sample.utime), {0.0, 0.0, sample.z});
  const auto size = [](const Series& series) {
    std::vector<double> norm;
    for (const Eigen::Vector3d& x : series.x) norm.push_back(x.norm());
    return median(std::move(norm));
  };
  // Floors follow the signal's own size, for its unit may be wrong.
  if (!run.gyro.empty()) clean("gyro", run.gyro, std::max(0.15, 2.0 * size(run.gyro)), true);
  if (!run.dvl.empty()) clean("dvl", run.dvl, std::max(0.15, 2.0 * size(run.dvl)), true);
  if (!run.specific_force.empty()) clean("accelerometer", run.specific_force, 3.0, false);
  return run;
}

}  // namespace

RunSignals read_signals(const Recording& recording, std::vector<ConsistencyFinding>& findings) {
  return Reader(recording, findings).read();
}

const PoseSeries& reference_pose(const RunSignals& run) {
  return run.pose.has_attitude || run.attitude.empty() ? run.pose : run.attitude;
}

Utime first_stamp(const Recording& recording) {
  Utime first = std::numeric_limits<Utime>::max();
  const auto earliest = [&](const auto& stream) {
    if (!stream.empty()) first = std::min(first, stream.front().utime);
  };
  earliest(recording.pose_capture);
  earliest(recording.ahrs);
  earliest(recording.dvl);
  earliest(recording.depth);
  earliest(recording.thrusters);
  return first == std::numeric_limits<Utime>::max() ? 0 : first;
}

}  // namespace fathom::estimation
