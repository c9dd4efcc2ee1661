// What the usual topics of each format mean: which stream they are, in which unit and frame. Facts of the formats'
// documents; a draft of a map is made of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/recordings/collector.hpp"

namespace fathom::recordings {

/// What a topic can serve as. Of several that can, one is drafted and the others are named.
enum class Quantity : std::uint8_t { kInertial, kAttitude, kPose, kVelocity, kDepth, kThrust, kBattery };

/// One topic as an entry of a map.
struct Entry {
  Quantity quantity{};
  int rank{};  ///< the least is drafted, then the one with more messages
  std::string topic;
  std::vector<std::string> lines;  ///< of the entry, without indentation
  std::string remark;              ///< what a person must check; empty: nothing
  bool drafted{true};              ///< false: never without a person's word, `remark` says why
};

/// Entries that a topic offers; none for a topic that is not known.
[[nodiscard]] std::vector<Entry> entries_of(const TopicAccount& topic);

/// Of a topic that is a file's named arrays (arrays/arrays.hpp).
void named_arrays(const TopicAccount& topic, std::vector<Entry>& out);

}  // namespace fathom::recordings
