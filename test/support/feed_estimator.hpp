// Hands a recording's samples to an estimator in the order of time, as a log would.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "common/estimation/online/estimator.hpp"
#include "common/samples/recording.hpp"

namespace fathom::test {

/// `lag` [us] holds back the velocity log's samples, as a slow channel would.
inline std::vector<StateEstimate> feed(estimation::Estimator& estimator, const Recording& recording, Utime lag = 0) {
  using Step = std::function<const estimation::Estimator::Output&()>;
  std::vector<std::pair<Utime, Step>> arrivals;
  const auto add = [&](const auto& samples, Utime later) {
    for (const auto& one : samples) {
      arrivals.emplace_back(one.utime + later, [&]() -> decltype(estimator.step(one)) { return estimator.step(one); });
    }
  };
  add(recording.pose_capture, 0);
  add(recording.ahrs, 0);
  add(recording.dvl, lag);
  add(recording.depth, 0);
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<StateEstimate> states;
  for (const auto& [utime, step] : arrivals) {
    const auto& output = step();
    states.insert(states.end(), output.begin(), output.end());
  }
  const auto& rest = estimator.finish();
  states.insert(states.end(), rest.begin(), rest.end());
  return states;
}

}  // namespace fathom::test
