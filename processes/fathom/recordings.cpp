#include "processes/fathom/recordings.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "common/base/error.hpp"
#include "common/estimation/run_signals.hpp"
#include "common/wire/streams.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/parts.hpp"

namespace fathom::tool {

std::vector<Recording> read_recordings(const std::vector<std::string>& paths, const std::string& map,
                                       std::vector<std::string>& notes,
                                       const std::optional<tables::SimulatedAxes>& simulated) {
  std::vector<Recording> recordings;
  const std::vector<std::string> names = names_of_runs(paths);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    FromSource read = read_source(sources_of({paths[i]}).front(), map, simulated);
    notes.insert(notes.end(), read.notes.begin(), read.notes.end());
    if (read.runs.size() != 1)
      throw InputError(paths[i] + ": holds " + std::to_string(read.runs.size()) +
                       " recordings, one behind the other; 'fathom import' writes each to a log of its own");
    recordings.push_back(std::move(read.runs.front()));
    recordings.back().name = names[i];
  }
  return recordings;
}

void sort_by_time(std::span<Recording> recordings, std::span<std::string> paths) {
  struct Run {
    Utime begin;
    Recording recording;
    std::string path;
  };
  std::vector<Run> runs;
  for (std::size_t i = 0; i < recordings.size(); ++i)
    runs.push_back({estimation::first_stamp(recordings[i]), std::move(recordings[i]), std::move(paths[i])});
  std::ranges::sort(runs, {}, [](const Run& run) { return std::tie(run.begin, run.recording.name); });
  for (std::size_t i = 0; i < runs.size(); ++i) {
    recordings[i] = std::move(runs[i].recording);
    paths[i] = std::move(runs[i].path);
  }
}

std::string counts(const Recording& recording) {
  std::string text;
  wire::visit_streams(recording, [&](const char* channel, const auto& stream) {
    if (!stream.empty())
      text += (text.empty() ? "" : ", ") + std::string{channel} + " " + std::to_string(stream.size());
  });
  return text;
}

}  // namespace fathom::tool
