// When a value was true. A message carries the time of its measurement on the clock of whoever measured, and the time
// of its receipt on the recording's. Intervals are taken from the first, which knows nothing of delays; the second only
// says where that clock begins.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/paged.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings {

/// Stamps of one topic of one recording.
struct TopicStamps {
  std::string topic;
  Paged<Stamp> stamps;
};

struct AlignedClocks {
  std::vector<Paged<std::int64_t>> times;  ///< us on the recording's clock, per topic as given
  std::vector<std::string> notes;          ///< one sentence per topic or clock
};

/// Times of measurement on the recording's clock. Where measured and log times agree to within two seconds they are the
/// same clock, and the difference is a delay. Others are clocks of their own, one for all topics whose least difference
/// agrees; each is set by its earliest arrival, and its rate by the earliest arrivals of its beginning and end.
[[nodiscard]] AlignedClocks align_clocks(const std::vector<TopicStamps>& topics);

}  // namespace fathom::recordings
