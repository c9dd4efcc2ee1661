#include "common/estimation/smoothing/noise_from_rest.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"

namespace fathom::estimation {
namespace {

constexpr double kBlock = 0.5;        // s
constexpr int kFewest = 8;            // samples that a standard deviation needs
constexpr double kStillMean = 4.0;    // sigma of a block's mean by which it may lie off the stretch's
constexpr double kStillSpeed = 0.01;  // m/s that a velocity log may show at rest: its own bias
constexpr double kGone = 4.0;         // sigma of the way that an instrument tells between a stretch's two halves
constexpr int kFewestHalf = 3;        // samples in each half that a way is told by
constexpr double kResolution = 1e-5;  // floor of a noise: a sensor that repeats itself to the last bit is rounded

/// Six numbers of the inertial package over one block.
struct Block {
  Utime from{}, to{};
  Vector6d mean{Vector6d::Zero()};
  int count{};
};

std::vector<Block> blocks_of(const std::vector<Ahrs>& stream) {
  std::vector<Block> blocks;
  for (const Ahrs& one : stream) {
    if (!one.has_rates) continue;
    if (blocks.empty() || seconds_between(blocks.back().from, one.utime) >= kBlock) {
      blocks.push_back({one.utime, one.utime});
    }
    Block& block = blocks.back();
    block.to = one.utime;
    block.mean.head<3>() += one.w_WB_B;
    if (one.has_specific_force) block.mean.tail<3>() += one.f_B;
    ++block.count;
  }
  for (Block& block : blocks) block.mean /= block.count;
  return blocks;
}

Vector6d white_noise(const std::vector<Ahrs>& stream) {
  Vector6d sigma;
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> series;
    for (const Ahrs& one : stream) {
      if (one.has_rates) series.push_back(axis < 3 ? one.w_WB_B[axis] : one.f_B[axis - 3]);
    }
    sigma[axis] = std::max(white_noise_sigma(series), kResolution);
  }
  return sigma;
}

/// One number that an instrument tells, over time.
struct Told {
  std::vector<double> t, x;  // s since the first inertial sample
  double sigma{};            // white noise of one
  double allowed{};          // what it may say at rest, and else than zero: infinite where it tells a place
};

template <class Stream, class Value>
void tell(const Stream& stream, Utime origin, const Value& value, std::vector<Told>& all,
          double allowed = std::numeric_limits<double>::infinity()) {
  Told told{.allowed = allowed};
  for (const auto& sample : stream) {
    const std::optional<double> x = value(sample);
    const double t = seconds_between(origin, sample.utime);
    if (!x || (!told.t.empty() && t <= told.t.back())) continue;
    told.t.push_back(t);
    told.x.push_back(*x);
  }
  if (told.x.size() < 2 * kFewestHalf) return;
  told.sigma = std::max(white_noise_sigma(told.t, told.x), kResolution);
  all.push_back(std::move(told));
}

/// What all instruments but gyro and accelerometer tell of the motion.
std::vector<Told> told_by(const Recording& recording) {
  std::vector<Told> all;
  const Utime origin = recording.ahrs.front().utime;
  const auto first = std::ranges::find_if(recording.ahrs, &Ahrs::has_attitude);
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (first != recording.ahrs.end()) {
      tell(
          recording.ahrs, origin,
          [&](const Ahrs& one) {
            return one.has_attitude
                       ? std::optional{rotation_vector_from_quaternion(first->q_WB.conjugate() * one.q_WB)[i]}
                       : std::nullopt;
          },
          all);
    }
    tell(
        recording.pose_capture, origin,
        [i](const PoseCapture& one) {
          return one.valid && one.has_position ? std::optional{one.p_WB[i]} : std::nullopt;
        },
        all);
    tell(
        recording.usbl, origin, [i](const Usbl& one) { return one.valid ? std::optional{one.p_WB[i]} : std::nullopt; },
        all);
    tell(
        recording.dvl, origin,
        [i](const Dvl& one) { return one.valid && !one.held ? std::optional{one.v_WB_B[i]} : std::nullopt; }, all,
        kStillSpeed);
  }
  for (Eigen::Index i = 0; i < 2; ++i)
    tell(
        recording.optical_flow, origin, [i](const OpticalFlow& one) { return std::optional{one.flow_C[i]}; }, all,
        kStillSpeed);
  tell(
      recording.depth, origin, [](const Depth& one) { return std::optional{one.z}; }, all);
  tell(
      recording.laser_range, origin, [](const LaserRange& one) { return std::optional{one.p_CL.norm()}; }, all);
  const std::size_t ranges = recording.ranges.empty() ? 0 : recording.ranges.front().range.size();
  for (std::size_t i = 0; i < ranges; ++i) {
    tell(
        recording.ranges, origin,
        [i](const Ranges& one) {
          return i < one.range.size() && i < one.valid.size() && one.valid[i] != 0 ? std::optional{one.range[i]}
                                                                                   : std::nullopt;
        },
        all);
  }
  return all;
}

/// Medians, since acoustic instruments tell a wild number now and then.
double median_between(const Told& told, double from, double to, int& count) {
  const auto begin = std::ranges::lower_bound(told.t, from), end = std::ranges::upper_bound(told.t, to);
  count = static_cast<int>(end - begin);
  if (count == 0) return 0.0;
  return median({told.x.begin() + (begin - told.t.begin()), told.x.begin() + (end - told.t.begin())});
}

/// Whether an instrument sees the vehicle go anywhere between two times. One that says nothing sees nothing.
bool moves(const Told& told, double from, double to) {
  int before = 0, after = 0;
  const double middle = 0.5 * (from + to);
  const double first = median_between(told, from, middle, before), second = median_between(told, middle, to, after);
  if (before < kFewestHalf || after < kFewestHalf) return false;
  // A median's standard deviation is 1.25 times a mean's; what rounding does comes on top, once.
  const double sigma = 1.25 * told.sigma * std::sqrt(1.0 / before + 1.0 / after);
  if (std::abs(second - first) > kGone * sigma) return true;
  return std::abs(0.5 * (first + second)) > told.allowed + 0.5 * kGone * sigma;
}

/// Standard deviation of what `value` says of every sample within the rest; nothing when there are too few.
template <class Stream, class Value>
std::optional<double> spread(const Stream& stream, const Rest& rest, const Value& value) {
  double sum = 0.0, square = 0.0;
  int count = 0;
  for (const auto& sample : stream) {
    if (sample.utime < rest.from || sample.utime > rest.to) continue;
    const std::optional<double> x = value(sample);
    if (!x) continue;
    sum += *x;
    square += *x * *x;
    ++count;
  }
  if (count < kFewest) return std::nullopt;
  const double mean = sum / count;
  return std::max(std::sqrt(std::max(square / count - mean * mean, 0.0) * count / (count - 1.0)), kResolution);
}

void set(double& noise, const std::optional<double>& found) {
  if (found) noise = *found;
}

}  // namespace

std::optional<Rest> find_rest(const Recording& recording, double shortest) {
  const std::vector<Block> blocks = blocks_of(recording.ahrs);
  if (blocks.size() < 2) return std::nullopt;
  const Vector6d sigma = white_noise(recording.ahrs);
  const std::vector<Told> others = told_by(recording);
  const Utime origin = recording.ahrs.front().utime;
  const auto still = [&](const Rest& rest) {
    return std::ranges::none_of(others, [&](const Told& told) {
      return moves(told, seconds_between(origin, rest.from), seconds_between(origin, rest.to));
    });
  };
  std::optional<Rest> best;
  for (std::size_t first = 0; first < blocks.size(); ++first) {
    Vector6d sum = Vector6d::Zero();
    std::size_t last = first;
    for (; last < blocks.size(); ++last) {
      const Block& block = blocks[last];
      const auto before = static_cast<double>(last - first);
      if (last > first) {
        const Vector6d off = (block.mean - sum / before).cwiseAbs().cwiseQuotient(sigma);
        if (off.maxCoeff() > kStillMean * std::sqrt((1.0 + 1.0 / before) / block.count)) break;
      }
      sum += block.mean;
    }
    const Rest rest{blocks[first].from, blocks[last - 1].to};
    if (seconds_between(rest.from, rest.to) < shortest) continue;
    if (!still(rest)) continue;
    if (!best || rest.to - rest.from > best->to - best->from) best = rest;
    first = last - 1;
  }
  return best;
}

KalmanSettings noise_from_rest(const Recording& recording, KalmanSettings settings, std::vector<std::string>& notes) {
  const std::optional<Rest> rest = find_rest(recording);
  if (!rest) {
    notes.push_back(recording.name + ": no stretch of 4 s in which the vehicle stands still; measurement noises are " +
                    "those of the settings");
    return settings;
  }
  for (int i = 0; i < 3; ++i) {
    const auto force = [i](const Ahrs& one) {
      return one.has_specific_force ? std::optional{one.f_B[i]} : std::nullopt;
    };
    const auto rate = [i](const Ahrs& one) { return one.has_rates ? std::optional{one.w_WB_B[i]} : std::nullopt; };
    set(settings.accelerometer_noise[i], spread(recording.ahrs, *rest, force));
    set(settings.gyro_noise[i], spread(recording.ahrs, *rest, rate));
  }
  const auto first = std::find_if(recording.ahrs.begin(), recording.ahrs.end(),
                                  [&](const Ahrs& one) { return one.has_attitude && one.utime >= rest->from; });
  const bool wanders = settings.attitude_memory > 0.0;  // which seconds of rest do not show
  if (first != recording.ahrs.end() && !wanders) {
    const auto heading = [&](const Ahrs& one) -> std::optional<double> {
      if (!one.has_attitude) return std::nullopt;
      return rotation_vector_from_quaternion(first->q_WB.conjugate() * one.q_WB).z();
    };
    double of_heading = settings.heading_noise.value_or(0.0);
    set(of_heading, spread(recording.ahrs, *rest, heading));
    if (of_heading > 0.0) settings.heading_noise = of_heading;
    set(settings.attitude_noise, spread(recording.ahrs, *rest, heading));
  }
  set(settings.depth_noise, spread(recording.depth, *rest, [](const Depth& one) { return std::optional{one.z}; }));
  double square = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < settings.transponders.size(); ++i) {
    const auto range = spread(recording.ranges, *rest, [i](const Ranges& one) {
      return i < one.valid.size() && one.valid[i] != 0 ? std::optional{one.range[i]} : std::nullopt;
    });
    if (!range) continue;
    square += *range * *range;
    ++count;
  }
  if (count > 0) settings.range_noise = std::sqrt(square / count);
  const auto log = [](const Dvl& one) { return one.valid && !one.held ? std::optional{one.v_WB_B.x()} : std::nullopt; };
  set(settings.velocity_noise, spread(recording.dvl, *rest, log));
  char text[240];
  std::snprintf(
      text, sizeof text,
      ": noises from %.1f s of rest: accelerometer %.3g m/s^2, gyro %.3g rad/s, heading %.3g rad%s, depth %.3g m, "
      "range %.3g m",
      seconds_between(rest->from, rest->to), settings.accelerometer_noise.mean(), settings.gyro_noise.mean(),
      settings.heading_noise.value_or(settings.attitude_noise), wanders ? " (as stated: it wanders)" : "",
      settings.depth_noise, settings.range_noise);
  notes.push_back(recording.name + text);
  return settings;
}

}  // namespace fathom::estimation
