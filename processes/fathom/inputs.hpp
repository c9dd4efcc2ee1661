// What people give as recordings: files of any known format, folders, patterns; to Recordings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/recordings/formats.hpp"
#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"

namespace fathom::tool {

/// One recording as somebody gave it: a file, or the files of a split one.
struct Source {
  std::string name;  ///< of the run
  std::vector<std::string> files;
  const recordings::Format* format{};  ///< null: a table of text, or an LCM log
  bool lcm{};

  [[nodiscard]] bool is_table() const { return format == nullptr && !lcm; }
};

/// Folders become the recordings in them, patterns ("dives/*.BIN") the files that match. A folder that is one recording
/// (a ROS 2 bag) stays one. InputError when something is not there, or holds nothing that can be read.
[[nodiscard]] std::vector<Source> sources_of(const std::vector<std::string>& arguments);

/// The same, each as one path, for commands that take recordings.
[[nodiscard]] std::vector<std::string> paths_of(const std::vector<std::string>& arguments);

/// What was recorded is not written over: InputError where `out` is the file `read`, by whatever path.
void refuse_over(const std::string& out, const std::string& read);

struct FromSource {
  std::vector<Recording> runs;  ///< several when a clock started anew within the file
  std::vector<std::string> notes;
};

/// Reads a source through a map, or its draft (tables: the canonical columns) when `map` is empty.
[[nodiscard]] FromSource read_source(const Source& source, const std::string& map,
                                     const std::optional<tables::SimulatedAxes>& simulated);

/// What a source holds, and the draft of its map: YAML that runs as it is.
[[nodiscard]] std::string describe_source(const Source& source, const std::optional<tables::SimulatedAxes>& simulated);

}  // namespace fathom::tool
