// Recordings of others to a Recording: topics through a map, each stream at the times of its topic.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/recordings/collector.hpp"
#include "common/recordings/damage.hpp"
#include "common/recordings/formats.hpp"
#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"
#include "common/tables/mapped_streams.hpp"

namespace fathom::recordings {

/// A recording of a known format: one file, or the parts of a split one in their order.
struct Files {
  std::vector<std::string> paths;
  const Format* format{};
  /// In the place of the format's own, where reading needs more than the file.
  std::function<void(const std::string& path, Sink& sink, Damage& damage)> read{};
};

/// What was read of it.
struct Content {
  Files files;
  std::unique_ptr<Collector> topics;
  Damage damage;

  [[nodiscard]] const std::string& path() const { return files.paths.front(); }
};

/// Reads the files once. `columns` are kept; InputError where a file has no beginning.
[[nodiscard]] Content read_files(const Files& files, std::set<std::string> columns, Collector::Take take);

/// What is to be said of what was read: damage, refused stamps.
[[nodiscard]] std::vector<std::string> remarks(const Content& content);

/// InputError where not one message could be read: with what was seen instead.
void require_messages(const Content& content);

struct ImportedRun {
  Recording recording;
  std::vector<std::string> notes;
};

struct ImportedFiles {
  std::vector<ImportedRun> runs;   ///< one, or as many as clocks started anew in the file
  std::vector<std::string> notes;  ///< what was lost, whose stamps were refused
};

/// Files on their way to samples, some after the others: of a long recording nothing is held but one part, its columns
/// lie on disk. `strict`: a stream that the files lack is an InputError (someone asked for it), else a note.
class PartedImport {
 public:
  /// Reads the files. InputError as read_files, and for a column that is in none of them.
  PartedImport(const Files& files, std::vector<tables::MappedStream> streams,
               std::optional<tables::SimulatedAxes> simulated, bool strict);
  ~PartedImport();
  PartedImport(const PartedImport&) = delete;
  PartedImport& operator=(const PartedImport&) = delete;

  /// As many as clocks started anew in the files, and one.
  [[nodiscard]] std::size_t recordings() const;
  /// Of the only recording: the samples of the next stretch of time, all streams up to the same moment, some `rows` of
  /// each at most (all that an attitude turns is held until its turn). False when nothing is left.
  bool next(std::size_t rows, Recording& out);
  /// Of the only recording, what next() has given, 0 to 1.
  [[nodiscard]] double share() const;
  /// After the last part: what was lost, refused or left out. InputError where nothing came.
  [[nodiscard]] std::vector<std::string> finish();
  /// Every recording as a whole, in the place of next() and finish().
  [[nodiscard]] ImportedFiles all();

 private:
  class Run;
  std::unique_ptr<Run> run(std::uint32_t recording);
  [[noreturn]] void nothing(const std::vector<std::string>& reasons) const;

  std::vector<tables::MappedStream> streams_;
  std::optional<tables::SimulatedAxes> simulated_;
  bool strict_;
  Content content_;
  std::vector<std::optional<std::size_t>> topics_;
  std::vector<std::string> notes_;
  std::unique_ptr<Run> run_;
};

/// PartedImport::all().
[[nodiscard]] ImportedFiles import_files(const Files& files, const std::vector<tables::MappedStream>& streams,
                                         const std::optional<tables::SimulatedAxes>& simulated, bool strict);

}  // namespace fathom::recordings
