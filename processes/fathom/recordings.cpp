#include "processes/fathom/recordings.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>
#include <utility>

#include "common/base/error.hpp"
#include "common/estimation/run_signals.hpp"
#include "common/wire/streams.hpp"
#include "processes/fathom/inputs.hpp"

namespace fathom::tool {

std::vector<Recording> read_recordings(const std::vector<std::string>& paths, const std::string& map,
                                       std::vector<std::string>& notes,
                                       const std::optional<tables::SimulatedAxes>& simulated) {
  std::vector<Recording> recordings;
  std::set<std::string> names;
  for (const std::string& path : paths) {
    const std::filesystem::path file{path};
    std::vector<Source> found = sources_of({path});
    if (found.size() != 1) throw InputError(path + ": holds " + std::to_string(found.size()) + " recordings");
    FromSource read = read_source(found.front(), map, simulated);
    notes.insert(notes.end(), read.notes.begin(), read.notes.end());
    if (read.runs.size() != 1)
      throw InputError(path + ": holds " + std::to_string(read.runs.size()) +
                       " recordings, one behind the other; 'fathom import' writes each to a log of its own");
    recordings.push_back(std::move(read.runs.front()));
    Recording& last = recordings.back();
    last.name = found.front().name;
    if (names.contains(last.name)) last.name = (file.parent_path().filename() / last.name).string();  // day2/run
    if (!names.insert(last.name).second) {
      throw InputError(path + ": a second recording named " + last.name + "; give each run once, under its own name");
    }
    for (const std::string& other : paths) {
      if (&other == &path) break;
      std::error_code unknown;
      if (std::filesystem::equivalent(other, path, unknown)) throw InputError(path + ": this is " + other + " again");
    }
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
