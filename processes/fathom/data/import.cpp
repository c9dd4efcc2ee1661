// fathom import: recordings of others to an LCM log, each stream on the channel that a driver would use.
#include "common/tables/import.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "common/base/error.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/vehicle.hpp"
#include "common/recordings/merge.hpp"
#include "common/recordings/worth.hpp"
#include "common/runtime/command_line.hpp"
#include "common/wire/log_writer.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/data/command_units.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

struct ImportOptions {
  std::vector<std::string> data, maps, shifts, types;
  std::string vehicle, out;
  bool describe{}, merge{};
};

/// "NAME=SECONDS" to the source that it names.
std::map<std::string, double> shifts_of(const ImportOptions& options, const std::vector<Source>& sources) {
  std::map<std::string, double> shifts;
  for (const std::string& text : options.shifts) {
    const std::size_t equal = text.rfind('=');
    std::size_t used = 0;
    double seconds = 0.0;
    try {
      if (equal != std::string::npos) seconds = std::stod(text.substr(equal + 1), &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || equal + 1 + used != text.size() || !std::isfinite(seconds))
      throw InputError("--shift " + text + ": must be NAME=SECONDS, NAME being one of the files");
    const std::string name = text.substr(0, equal);
    const bool known = std::ranges::any_of(sources, [&](const Source& each) {
      return each.name == name || each.files.front() == name ||
             std::filesystem::path(each.files.front()).filename() == name;
    });
    if (!known) throw InputError("--shift " + text + ": no file is named " + name);
    shifts[name] = seconds;
  }
  return shifts;
}

std::optional<double> shift_of(const Source& source, const std::map<std::string, double>& shifts) {
  for (const std::string& name :
       {source.name, source.files.front(), std::filesystem::path(source.files.front()).filename().string()}) {
    if (const auto found = shifts.find(name); found != shifts.end()) return found->second;
  }
  return std::nullopt;
}

/// Names of logs in one folder: the recording's, with its folder's in front where two have the same.
std::vector<std::string> names_of(const std::vector<Source>& sources) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Source& source : sources) {
    std::string name = source.name;
    if (taken.contains(name))
      name = std::filesystem::absolute(source.files.front()).parent_path().filename().string() + "-" + name;
    if (!taken.insert(name).second)
      throw InputError(source.files.front() + ": another recording is named " + name + "; give it a folder of its own");
    names.push_back(name);
  }
  return names;
}

void refuse_source(const std::string& path, const std::vector<Source>& sources) {
  static std::set<std::string> written;  // by this command
  if (!written.insert(path).second)
    throw InputError(path + ": another recording of this import is already there; give it a folder of its own");
  for (const Source& source : sources) {
    for (const std::string& file : source.files) refuse_over(path, file);
  }
}

void say(const recordings::Worth& worth, wire::LogWriter& log, const std::string& path) {
  const std::uint64_t events = log.finish();
  for (const std::string& reason : worth.against_fitting()) std::printf("%s: ! %s\n", path.c_str(), reason.c_str());
  std::printf("%s: %llu messages (%s)\n", path.c_str(), static_cast<unsigned long long>(events), log.counts().c_str());
}

void write(const Recording& recording, const std::string& path, const std::vector<Source>& sources) {
  refuse_source(path, sources);
  recordings::Worth worth;
  wire::LogWriter log{path};
  worth.take(recording);
  log.append(recording);
  say(worth, log, path);
}

/// A table to a log, some rows after the others: its samples never stand in memory together.
void write_table(const Source& source, const std::string& map, const std::optional<tables::SimulatedAxes>& simulated,
                 std::optional<double> shift, const std::string& path, const std::vector<Source>& sources) {
  constexpr std::size_t kRows = 50'000;
  refuse_source(path, sources);
  tables::MappedTable mapped = tables::read_mapped(source.files.front(), map);
  tables::TableImport import{mapped.table, std::move(mapped.map), simulated};
  recordings::Worth worth;
  wire::LogWriter log{path};
  for (Recording part{.name = source.name}; import.next(kRows, part); part = {.name = source.name}) {
    if (shift) recordings::shift(part, *shift);
    worth.take(part);
    log.append(part);
  }
  for (const auto& notes : {mapped.notes, import.finish()}) {
    for (const std::string& note : notes) std::printf("%s: %s\n", source.files.front().c_str(), note.c_str());
  }
  say(worth, log, path);
}

/// Of a recording with topics that is one run, some seconds after the others.
void write_topics(recordings::PartedImport& import, const std::string& name, std::optional<double> shift,
                  const std::string& path, const std::vector<Source>& sources) {
  constexpr std::size_t kRows = 50'000;
  refuse_source(path, sources);
  recordings::Worth worth;
  wire::LogWriter log{path};
  for (Recording part{.name = name}; import.next(kRows, part); part = {.name = name}) {
    if (shift) recordings::shift(part, *shift);
    worth.take(part);
    log.append(part);
  }
  for (const std::string& note : import.finish()) std::printf("%s\n", note.c_str());
  say(worth, log, path);
}

/// The tables of a log's channels to the log: whatever they are of, message by message.
void write_channels(const Source& source, const std::string& path, const std::vector<Source>& sources) {
  refuse_source(path, sources);
  const exports::Restored restored = exports::from_csv(source.channels, path);
  if (!restored.note.empty()) std::printf("%s: %s\n", source.files.front().c_str(), restored.note.c_str());
  std::string counts;
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : restored.written) {
    counts += (counts.empty() ? "" : ", ") + channel + " " + std::to_string(count);
    messages += count;
  }
  std::printf("%s: %llu messages (%s)\n", path.c_str(), static_cast<unsigned long long>(messages), counts.c_str());
}

/// All runs that came, each to a log of its own; `out` with the run's number where there are several.
void write_each(const std::vector<Recording>& runs, const std::string& out, const std::vector<Source>& sources) {
  const std::filesystem::path path{out};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::filesystem::path own = path;
    if (runs.size() > 1)
      own.replace_filename(path.stem().string() + "-" + std::to_string(i + 1) + path.extension().string());
    write(runs[i], own.string(), sources);
  }
}

/// Recordings of one name, from whatever folder and in whatever format, to one run each.
void write_merged(const ImportOptions& options, const std::vector<Source>& sources,
                  const std::optional<tables::SimulatedAxes>& simulated) {
  std::filesystem::create_directories(options.out);
  std::map<std::string, std::vector<Recording>> runs;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    FromSource read =
        read_source(sources[i], options.maps.empty() ? "" : options.maps[options.maps.size() == 1 ? 0 : i], simulated);
    for (const std::string& note : read.notes) std::printf("%s\n", note.c_str());
    if (read.runs.size() > 1)
      throw InputError(sources[i].files.front() + ": holds " + std::to_string(read.runs.size()) +
                       " recordings, one behind the other; import it alone first, then merge what comes of it");
    std::vector<Recording>& parts = runs[sources[i].name];
    parts.push_back(std::move(read.runs.front()));
    parts.back().name = sources[i].files.front();  // parts of a run have its name in common
  }
  for (auto& [name, parts] : runs) {
    std::vector<std::string> notes;
    const std::vector<std::optional<double>> stated(parts.size());
    const Recording merged = recordings::merge(std::move(parts), stated, notes);
    for (const std::string& note : notes) std::printf("%s\n", note.c_str());
    write(merged, (std::filesystem::path(options.out) / (name + ".lcmlog")).string(), sources);
  }
}

void run_import(const ImportOptions& options) {
  std::optional<tables::SimulatedAxes> simulated;
  std::optional<model::Vehicle> vehicle;
  if (!options.vehicle.empty()) {
    vehicle = model::Vehicle::load(options.vehicle);
    simulated = vehicle->dof;
    for (const std::string& map : options.maps) check_command_units(map, *vehicle);
    if (const std::string note = model::undriven_note(*vehicle); !note.empty())
      std::printf("%s%s\n", options.describe ? "# " : "", note.c_str());
  }
  const std::vector<Source> sources = sources_of(options.data, options.types);
  if (options.describe) {
    for (const Source& source : sources) std::printf("%s", describe_source(source, vehicle).c_str());
    return;
  }
  if (options.out.empty()) throw InputError("--out is missing: the log to write, or a folder for several runs");
  if (options.maps.size() > 1 && options.maps.size() != sources.size())
    throw InputError("--map is given " + std::to_string(options.maps.size()) + " times for " +
                     std::to_string(sources.size()) + " recordings: once for all, or once for each");
  const bool folder = options.out.ends_with('/') || std::filesystem::is_directory(options.out);
  const std::map<std::string, double> shifts = shifts_of(options, sources);
  if (folder && !shifts.empty()) throw InputError("--shift is for files of one run; --out names a folder of several");
  if (options.merge && !folder)
    throw InputError("--merge makes a run of the recordings of each name, in a folder: --out FOLDER/");
  if (options.merge) {
    write_merged(options, sources, simulated);
    return;
  }
  const std::vector<std::string> names = folder ? names_of(sources) : std::vector<std::string>{};
  std::vector<Recording> parts;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::string map = options.maps.empty() ? "" : options.maps[options.maps.size() == 1 ? 0 : i];
    if (folder) std::filesystem::create_directories(options.out);
    if (sources[i].is_table() && (folder || sources.size() == 1)) {
      write_table(sources[i], map, simulated, shift_of(sources[i], shifts),
                  folder ? (std::filesystem::path(options.out) / (names[i] + ".lcmlog")).string() : options.out,
                  sources);
      continue;
    }
    if (!sources[i].channels.empty() && map.empty() && (folder || sources.size() == 1) &&
        !shift_of(sources[i], shifts)) {
      write_channels(sources[i],
                     folder ? (std::filesystem::path(options.out) / (names[i] + ".lcmlog")).string() : options.out,
                     sources);
      continue;
    }
    FromSource read;
    if (sources[i].has_topics() && (folder || sources.size() == 1)) {
      const auto import = parted_import(sources[i], map, simulated, read.notes);
      if (import->recordings() == 1) {
        for (const std::string& note : read.notes) std::printf("%s\n", note.c_str());
        write_topics(*import, sources[i].name, shift_of(sources[i], shifts),
                     folder ? (std::filesystem::path(options.out) / (names[i] + ".lcmlog")).string() : options.out,
                     sources);
        continue;
      }
      add_runs(import->all(), sources[i], read);
    } else {
      read = read_source(sources[i], map, simulated);
    }
    for (const std::string& note : read.notes) std::printf("%s\n", note.c_str());
    if (folder) {
      write_each(read.runs, (std::filesystem::path(options.out) / (names[i] + ".lcmlog")).string(), sources);
    } else if (sources.size() == 1) {
      if (const auto shift = shift_of(sources[i], shifts)) {
        for (Recording& each : read.runs) recordings::shift(each, *shift);
      }
      write_each(read.runs, options.out, sources);
    } else if (read.runs.size() > 1) {
      throw InputError(sources[i].files.front() + ": holds " + std::to_string(read.runs.size()) +
                       " recordings, one behind the other; import it alone first, then merge what comes of it");
    } else {
      parts.push_back(std::move(read.runs.front()));
      parts.back().name = sources[i].name;
    }
  }
  if (parts.empty()) return;
  std::vector<std::optional<double>> stated;
  for (const Source& source : sources) stated.push_back(shift_of(source, shifts));
  std::vector<std::string> notes;
  const Recording merged = recordings::merge(std::move(parts), stated, notes);
  for (const std::string& note : notes) std::printf("%s\n", note.c_str());
  write(merged, options.out, sources);
}

}  // namespace

void add_import(runtime::CommandLine& app) {
  auto options = std::make_shared<ImportOptions>();
  runtime::CommandLine* command = app.add_subcommand("import", "recordings of others to an LCM log");
  std::string known = "files, folders or patterns: tables of text";
  for (const recordings::Format& format : recordings::formats()) known += ", " + std::string{format.title};
  command->add_option("data", options->data, known)->required();
  command->add_flag("--describe", options->describe,
                    "prints what the recording holds and the draft of a map, instead of importing");
  command->add_option(
      "--map", options->maps,
      "YAML file that says what each column is; without: canonical columns, or the draft of --describe");
  command->add_flag("--merge", options->merge, "recordings of one name are one run each, in --out FOLDER/");
  command->add_option("--types", options->types, ".lcm files that define the types of another project's LCM logs");
  command->add_option("--vehicle", options->vehicle,
                      "vehicle file: columns of axes that it does not simulate may lack");
  command->add_option("--shift", options->shifts, "NAME=SECONDS: added to the times of this file");
  command->add_option("--out", options->out,
                      "log to write, RUN.lcmlog: several files become one run; or a folder: each is a run of its own");
  command->callback([options] { run_import(*options); });
}

}  // namespace fathom::tool
