// Hands a recording's samples to an estimator in the order of time, as a log would.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "common/estimation/estimator.hpp"
#include "common/samples/recording.hpp"

namespace fathom::test {

/// `lag` [us] holds back the velocity log's samples, as a slow channel would.
inline std::vector<StateEstimate> feed(estimation::Estimator& estimator, const Recording& recording, Utime lag = 0) {
  struct Arrival {
    Utime utime;
    std::function<const estimation::Estimator::Output&()> step;
  };
  std::vector<Arrival> arrivals;
  for (const PoseCapture& one : recording.pose_capture) {
    arrivals.push_back({one.utime, [&]() -> const auto& { return estimator.step(one);
  }
});
}  // namespace fathom::test
for (const Ahrs& one : recording.ahrs) {
    arrivals.push_back({one.utime, [&]() -> const auto& { return estimator.step(one);
}
});
}
for (const Dvl& one : recording.dvl) {
    arrivals.push_back({one.utime + lag, [&]() -> const auto& { return estimator.step(one);
}
});
}
for (const Depth& one : recording.depth) {
    arrivals.push_back({one.utime, [&]() -> const auto& { return estimator.step(one);
}
});
}
std::stable_sort(arrivals.begin(), arrivals.end(),
                 [](const Arrival& a, const Arrival& b) { return a.utime < b.utime; });
std::vector<StateEstimate> states;
for (const Arrival& arrival : arrivals) {
  const auto& output = arrival.step();
  states.insert(states.end(), output.begin(), output.end());
}
const auto& rest = estimator.finish();
states.insert(states.end(), rest.begin(), rest.end());
return states;
}

}  // namespace fathom::test
