// Recordings of any length in groups that fit into memory: what takes little is one group, as it was given; a long
// recording comes part after part.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"

namespace fathom::tool {

/// Of samples in memory at a time, in bytes: an hour of pose, attitude, velocity and thrusters at 100 Hz takes 121 MB
/// and stays whole; what is made of them takes twice as much again.
inline constexpr std::size_t kMostHeld = std::size_t{128} << 20U;

/// A part of a recording, or all of it.
struct RunPart {
  Recording recording;  ///< "dive", or "dive from 3600 s" where it is the second part or a later one
  std::size_t run{};    ///< number of the recording in the order of the paths
};

/// Names of all recordings by their paths, each once. InputError where a run is given twice.
[[nodiscard]] std::vector<std::string> names_of_runs(const std::vector<std::string>& paths);

struct GroupOptions {
  std::string map;
  std::optional<tables::SimulatedAxes> simulated;
  std::size_t most{kMostHeld};
};

/// use(group) for groups of whole recordings, or with one part of a long one. A part begins with the last sample of
/// each stream of the part before, so that no gap lies between two parts. Notes go to `notes`. InputError as
/// read_recordings().
void in_groups(const std::vector<std::string>& paths, const GroupOptions& options, std::vector<std::string>& notes,
               const std::function<void(std::vector<RunPart>&)>& use);

/// What is looked at of recordings where a look at all of it would not fit into memory.
struct Stretched {
  std::vector<Recording> recordings;
  std::vector<std::size_t> run;  ///< number of the recording, in the order of the paths, that each is of
};

/// read_recordings(), but of a recording that takes more than `options.most` stretches alone, spread evenly over it,
/// that together take no more; each is a recording of its own, "dive from 3600 s". A note says so.
[[nodiscard]] Stretched read_stretches(const std::vector<std::string>& paths, const GroupOptions& options,
                                       std::vector<std::string>& notes);

}  // namespace fathom::tool
