// Recordings of others to a Recording: topics through a map, each stream at the times of its topic.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/recordings/content.hpp"
#include "common/samples/recording.hpp"
#include "common/tables/absent.hpp"
#include "common/tables/mapped_streams.hpp"

namespace fathom::recordings {

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
