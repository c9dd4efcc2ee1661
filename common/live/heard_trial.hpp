// The trial so far as recordings: every sample that was heard, each stream in the order of its stamps, as a log of the
// same messages would give it. Whatever the order of arrival.
#pragma once

#include <cstdint>
#include <map>
#include <type_traits>
#include <vector>

#include "common/base/time.hpp"
#include "common/samples/recording.hpp"
#include "common/wire/streams.hpp"

namespace fathom::live {

/// Holds `most` seconds at most. Of a longer trial every second minute is kept, then every fourth: spread evenly over
/// it.
class HeardTrial {
 public:
  explicit HeardTrial(double most) : most_{most} {}

  template <class Sample>
  void hear(const Sample& sample) {
    Recording* part = part_of(sample.utime);
    if (part == nullptr) return;
    wire::visit_streams(*part, [&](const char*, auto& stream) {
      if constexpr (std::is_same_v<typename std::decay_t<decltype(stream)>::value_type, Sample>)
        stream.push_back(sample);
    });
  }
  void reset();

  /// What was stamped until then: the trial, or the parts that are kept of a long one, named by their beginning.
  [[nodiscard]] std::vector<Recording> until(Utime end) const;

 private:
  /// Where a sample of this time goes; null: into a part that is not kept.
  [[nodiscard]] Recording* part_of(Utime utime);
  [[nodiscard]] bool keeps(std::int64_t part) const;

  double most_;                              ///< s
  std::map<std::int64_t, Recording> parts_;  ///< by minutes of the clock
  std::int64_t first_{}, every_{1};          ///< part that is kept, and every so many after it
};

}  // namespace fathom::live
