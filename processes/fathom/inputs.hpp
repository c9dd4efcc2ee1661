// What people give as recordings: files of any known format, folders, patterns; to Recordings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/exports/channel_tables.hpp"
#include "common/exports/foreign_lcm.hpp"
#include "common/model/vehicle.hpp"
#include "common/recordings/formats.hpp"
#include "common/recordings/import.hpp"
#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"

namespace fathom::tool {

/// One recording as somebody gave it: a file, or the files of a split one.
struct Source {
  std::string name;  ///< of the run
  std::vector<std::string> files;
  const recordings::Format* format{};  ///< null: a table of text, or an LCM log
  bool lcm{};
  std::vector<exports::ChannelTable> channels;  ///< of a log: `files` are what 'fathom export --to csv' made of it

  std::shared_ptr<const exports::ForeignLcm> types;  ///< of an LCM log of another project

  [[nodiscard]] bool is_table() const { return format == nullptr && !lcm && !types && channels.empty(); }
  [[nodiscard]] bool has_topics() const { return format != nullptr || types; }
  [[nodiscard]] recordings::Files topics() const;
};

/// Folders become the recordings in them, patterns ("dives/*.BIN") the files that match. A folder that is one recording
/// (a ROS 2 bag) stays one, and so do the tables of a log's channels in one folder. InputError when something is not
/// there, or holds nothing that can be read.
/// `types`: .lcm files; LCM logs are of the project that these define.
[[nodiscard]] std::vector<Source> sources_of(const std::vector<std::string>& arguments,
                                             const std::vector<std::string>& types = {});

/// The same, each as one path, for commands that take recordings.
[[nodiscard]] std::vector<std::string> paths_of(const std::vector<std::string>& arguments);

/// What was recorded is not written over: InputError where `out` is the file `read`, by whatever path.
void refuse_over(const std::string& out, const std::string& read);

struct FromSource {
  std::vector<Recording> runs;  ///< several when a clock started anew within the file
  std::vector<std::string> notes;
};

/// A log that was made again of the tables of its channels, for as long as this lives.
class RestoredLog {
 public:
  explicit RestoredLog(const Source& source);
  ~RestoredLog();
  RestoredLog(const RestoredLog&) = delete;
  RestoredLog& operator=(const RestoredLog&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& note() const { return note_; }

 private:
  std::string folder_, path_, note_;
};

/// A source with topics on its way to samples, through a map or its draft; what is to be said of that goes to `notes`.
[[nodiscard]] std::unique_ptr<recordings::PartedImport> parted_import(
    const Source& source, const std::string& map, const std::optional<tables::SimulatedAxes>& simulated,
    std::vector<std::string>& notes);

/// Runs and notes of an import, under the source's name where it is one.
void add_runs(recordings::ImportedFiles imported, const Source& source, FromSource& out);

/// Reads a source through a map, or its draft (tables: the canonical columns) when `map` is empty.
[[nodiscard]] FromSource read_source(const Source& source, const std::string& map,
                                     const std::optional<tables::SimulatedAxes>& simulated);

/// What a source holds, and the draft of its map: YAML that runs as it is, as far as this vehicle moves.
[[nodiscard]] std::string describe_source(const Source& source, const std::optional<model::Vehicle>& vehicle);

}  // namespace fathom::tool
