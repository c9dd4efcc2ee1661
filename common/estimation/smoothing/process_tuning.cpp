#include "common/estimation/smoothing/process_tuning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/error.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"

namespace fathom::estimation {
namespace {

template <class Stream>
void cut(Stream& stream, Utime end) {
  stream.erase(std::find_if(stream.begin(), stream.end(), [end](const auto& one) { return one.utime > end; }),
               stream.end());
}

Recording beginning(const Recording& recording, double longest) {
  Recording part;
  part.name = recording.name;
  part.ahrs = recording.ahrs;
  part.pose_capture = recording.pose_capture;
  part.dvl = recording.dvl;
  part.depth = recording.depth;
  part.usbl = recording.usbl;
  part.ranges = recording.ranges;
  part.tag_pose = recording.tag_pose;
  part.optical_flow = recording.optical_flow;
  part.laser_range = recording.laser_range;
  const Utime origin = !part.ahrs.empty()           ? part.ahrs.front().utime
                       : !part.pose_capture.empty() ? part.pose_capture.front().utime
                                                    : Utime{};
  const Utime end = utime_after(origin, longest);
  cut(part.ahrs, end);
  cut(part.pose_capture, end);
  cut(part.dvl, end);
  cut(part.depth, end);
  cut(part.usbl, end);
  cut(part.ranges, end);
  cut(part.tag_pose, end);
  cut(part.optical_flow, end);
  cut(part.laser_range, end);
  return part;
}

/// Settings under which the run is lost altogether have no likelihood.
double score(const Recording& recording, const KalmanSettings& settings) {
  try {
    const double found = likelihood(recording, settings);
    return std::isfinite(found) ? found : -std::numeric_limits<double>::infinity();
  } catch (const InputError&) {
    return -std::numeric_limits<double>::infinity();
  }
}

}  // namespace

KalmanSettings tune_process(const Recording& recording, KalmanSettings settings, double longest,
                            const Progress& progress) {
  const Recording part = beginning(recording, longest);
  std::vector<double*> tuned{&settings.process.jerk, &settings.process.angular_jerk};
  if (settings.model == KinematicModel::kPrinted) tuned.push_back(&settings.process.velocity);
  constexpr const char* kTuning = "tuning";
  constexpr std::array kFirst{1.0, 0.2, 5.0, 25.0};
  constexpr std::array kFactors{3.0, 1.5, 1.2};
  const double fewest = kFirst.size() + 2.0 * static_cast<double>(tuned.size() * kFactors.size());
  double tried = 0.0;
  progress.begin(kTuning, "tuning the process noise");
  const auto score_of = [&] {
    progress.expect(kTuning, std::max(1.5 * fewest - tried, 1.0));  // half as many again find something better
    const double now = score(part, settings);
    progress.done(kTuning);
    tried += 1.0;
    return now;
  };
  // A first look from sluggish to lively: a filter that is far too slow loses the run, and no small step mends that.
  double best = -std::numeric_limits<double>::infinity(), liveliest = 1.0;
  const ProcessNoise given = settings.process;
  const auto scaled = [&](double factor) {
    settings.process.jerk = factor * given.jerk;
    settings.process.angular_jerk = factor * given.angular_jerk;
    settings.process.velocity = given.velocity;
  };
  for (const double factor : kFirst) {
    scaled(factor);
    const double now = score_of();
    if (now <= best) continue;
    best = now;
    liveliest = factor;
  }
  scaled(liveliest);
  for (const double factor : kFactors) {
    for (double* one : tuned) {
      for (const double way : {factor, 1.0 / factor}) {
        for (;;) {
          const double kept = *one;
          *one *= way;
          const double now = *one > 1e-7 && *one < 1e3 ? score_of() : best;
          if (now <= best) {
            *one = kept;
            break;
          }
          best = now;
        }
      }
    }
  }
  progress.expect(kTuning, 0);
  return settings;
}

}  // namespace fathom::estimation
