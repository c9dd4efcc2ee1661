#include "processes/fathom/inputs.hpp"

#include <glob.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <utility>

#include "common/base/error.hpp"
#include "common/recordings/draft.hpp"
#include "common/recordings/import.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/table_draft.hpp"
#include "common/recordings/worth.hpp"
#include "common/tables/import.hpp"
#include "common/wire/log_reader.hpp"
#include "common/wire/streams.hpp"

namespace fathom::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kRowsAtOnce = 50'000;

bool is_lcm(const std::string& path) {
  constexpr std::uint32_t kSync = 0xEDA1DA01;
  recordings::FileWindow file{path};
  const recordings::Bytes head = file.at(0, 4);
  const std::string extension = fs::path(path).extension().string();
  return (head.size() == 4 && recordings::big<std::uint32_t>(head) == kSync) || extension == ".lcmlog" ||
         extension == ".lcm";
}

/// Text, as far as its first bytes tell.
bool is_text(const std::string& path) {
  recordings::FileWindow file{path};
  const recordings::Bytes head = file.at(0, 4096);
  return std::ranges::none_of(head, [](std::uint8_t byte) { return byte == 0; });
}

std::string known_formats() {
  std::string text;
  for (const recordings::Format& format : recordings::formats()) text += std::string{format.title} + ", ";
  return text + "an LCM log, or a table of text";
}

Source source_of(const std::string& path) {
  if (!fs::exists(path)) throw InputError(path + ": no such file");
  Source source{.name = fs::path(path).stem().string(), .files = {path}};
  source.format = recordings::format_of(path);
  if (source.format != nullptr) return source;
  source.lcm = is_lcm(path);
  if (!source.lcm && is_text(path)) {
    if (const auto table = exports::channel_table(path)) source.channels.push_back(*table);
    return source;
  }
  if (!source.lcm) throw InputError(path + ": what it holds is not known; known are: " + known_formats());
  return source;
}

bool is_bag(const std::string& extension) {
  return extension == ".db3" || extension == ".mcap" || extension == ".zstd";
}

/// "bag_2.db3" before "bag_10.db3": a number within a name counts as one.
bool before(const fs::path& one, const fs::path& other) {
  const std::string a = one.string(), b = other.string();
  const auto run = [](const std::string& text, std::size_t at) {
    return std::min(text.find_first_not_of("0123456789", at), text.size()) - at;
  };
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    const std::size_t digits = run(a, i), others = run(b, k);
    if (digits > 0 && others > 0 && digits != others) return digits < others;
    const std::size_t count = digits > 0 && others > 0 ? digits : 1;
    if (const int order = a.compare(i, count, b, k, count); order != 0) return order < 0;
    i += count;
    k += count;
  }
  return a.size() < b.size();
}

void take_folder(const fs::path& folder, std::vector<Source>& sources) {
  std::vector<fs::path> files;
  bool bag = fs::exists(folder / "metadata.yaml");
  bool only_parts = true;
  for (const auto& entry : fs::directory_iterator{folder}) {
    if (!entry.is_regular_file() || entry.path().filename().string().starts_with(".")) continue;
    files.push_back(entry.path());
    only_parts = only_parts && (entry.path().extension() == ".db3" || entry.path().filename() == "metadata.yaml");
  }
  std::ranges::sort(files, before);
  bag = bag || (only_parts && !files.empty());
  const fs::path plain = folder.lexically_normal();
  Source whole{.name = (plain.has_filename() ? plain : plain.parent_path()).filename().string()};
  const std::size_t known = sources.size();
  for (const fs::path& file : files) {
    const std::string extension = file.extension().string();
    if (bag) {
      if (!is_bag(extension)) continue;
      const recordings::Format* format = recordings::format_of(file.string());
      if (format == nullptr) continue;
      if (whole.format == nullptr) whole.format = format;
      if (whole.format == format) whole.files.push_back(file.string());
      continue;
    }
    const recordings::Format* format = recordings::format_of(file.string());
    if (format != nullptr || extension == ".csv" || extension == ".tsv" || extension == ".lcmlog" ||
        extension == ".lcm")
      sources.push_back(source_of(file.string()));
  }
  if (bag && !whole.files.empty()) sources.push_back(whole);
  if (sources.size() == known)
    throw InputError(folder.string() + ": holds no recording; known are: " + known_formats());
}

std::vector<std::string> matches(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> paths;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) paths.emplace_back(found.gl_pathv[i]);
  }
  ::globfree(&found);
  if (paths.empty()) throw InputError(pattern + ": no file matches");
  return paths;
}

std::vector<std::string> expanded(const std::vector<std::string>& arguments) {
  std::vector<std::string> paths;
  for (const std::string& argument : arguments) {
    std::error_code unknown;
    if (!fs::exists(argument, unknown) && argument.find_first_of("*?[") != std::string::npos) {
      for (const std::string& each : matches(argument)) paths.push_back(each);
    } else {
      paths.push_back(argument);
    }
  }
  return paths;
}

/// The folder of a log's channels, named after the log.
std::string log_name(const fs::path& table) {
  constexpr std::string_view kExported = "_csv";  // as 'fathom export' names it
  std::string name = fs::absolute(table).lexically_normal().parent_path().filename().string();
  if (name.ends_with(kExported) && name.size() > kExported.size()) name.resize(name.size() - kExported.size());
  return name;
}

/// Where a channel's messages stand in a log among those of the same time: causes first (wire/streams.hpp).
std::size_t place_among_equals(const exports::ChannelTable& table) {
  static const std::vector<std::string> kOrder = [] {
    std::vector<std::string> order;
    const Recording none;
    wire::visit_streams(none, [&](const char* channel, const auto&) { order.emplace_back(channel); });
    return order;
  }();
  return static_cast<std::size_t>(std::ranges::find(kOrder, table.channel) - kOrder.begin());
}

/// Tables of channels that lie in one folder are one recording.
void join_channels(std::vector<Source>& sources) {
  std::vector<Source> joined;
  for (Source& source : sources) {
    const auto folder = [](const Source& one) { return fs::path{one.files.front()}.parent_path(); };
    const auto same = std::ranges::find_if(joined, [&](const Source& other) {
      return !source.channels.empty() && !other.channels.empty() && folder(other) == folder(source);
    });
    if (same == joined.end()) {
      joined.push_back(std::move(source));
      continue;
    }
    same->name = log_name(same->files.front());
    same->files.push_back(source.files.front());
    same->channels.push_back(source.channels.front());
  }
  for (Source& source : joined) std::ranges::stable_sort(source.channels, {}, place_among_equals);
  sources = std::move(joined);
}

/// Tables of one log's channels, given one by one ("run_csv/*.csv"), as their folder.
std::vector<std::string> by_folder(const std::vector<std::string>& paths) {
  const auto folder_of = [](const std::string& path) -> std::string {
    const bool table = fs::path{path}.extension() == ".csv" && !fs::is_directory(path) && exports::channel_table(path);
    const std::string folder = fs::path{path}.parent_path().string();
    return !table ? "" : folder.empty() ? "." : folder;
  };
  std::vector<std::string> folders, out;
  for (const std::string& path : paths) folders.push_back(folder_of(path));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool several = !folders[i].empty() && std::ranges::count(folders, folders[i]) > 1;
    if (!several) {
      out.push_back(paths[i]);
    } else if (std::ranges::find(out, folders[i]) == out.end()) {
      out.push_back(folders[i]);
    }
  }
  return out;
}

recordings::Content look_at(const Source& source) {
  recordings::Content content = recordings::read_files(source.topics(), {}, recordings::Collector::Take::kEverything);
  recordings::require_messages(content);
  return content;
}

}  // namespace

recordings::Files Source::topics() const {
  return types ? types->files(files) : recordings::Files{.paths = files, .format = format};
}

std::vector<Source> sources_of(const std::vector<std::string>& arguments, const std::vector<std::string>& types) {
  std::vector<Source> sources;
  for (const std::string& path : expanded(arguments)) {
    if (fs::is_directory(path)) {
      take_folder(path, sources);
    } else {
      sources.push_back(source_of(path));
    }
  }
  join_channels(sources);
  if (types.empty()) return sources;
  const auto foreign = std::make_shared<const exports::ForeignLcm>(types);
  for (Source& source : sources) {
    if (std::exchange(source.lcm, false)) source.types = foreign;
  }
  return sources;
}

std::vector<std::string> paths_of(const std::vector<std::string>& arguments) {
  std::vector<std::string> paths;
  for (const std::string& path : by_folder(expanded(arguments))) {
    if (!fs::is_directory(path)) {
      paths.push_back(path);
      continue;
    }
    std::vector<Source> sources;
    take_folder(path, sources);
    join_channels(sources);
    for (const Source& each : sources) paths.push_back(each.files.size() > 1 ? path : each.files.front());
  }
  return paths;
}

RestoredLog::RestoredLog(const Source& source) {
  std::string pattern = (fs::temp_directory_path() / "fathom-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    throw InputError(pattern + ": cannot be made; set TMPDIR to a folder that can be written");
  folder_ = pattern;
  path_ = (fs::path{folder_} / (source.name + ".lcmlog")).string();
  try {
    note_ = exports::from_csv(source.channels, path_).note;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    throw;
  }
}

RestoredLog::~RestoredLog() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::unique_ptr<recordings::PartedImport> parted_import(const Source& source, const std::string& map,
                                                        const std::optional<tables::SimulatedAxes>& simulated,
                                                        std::vector<std::string>& notes) {
  const std::string& path = source.files.front();
  if (!map.empty())
    return std::make_unique<recordings::PartedImport>(source.topics(), tables::load_streams(map), simulated, true);
  const std::string draft = recordings::draft_map(look_at(source));
  if (draft.empty())
    throw InputError(path +
                     ": holds no usual topic; 'fathom import --describe' lists what it holds, for a map (--map)");
  notes.push_back(path + ": read with the draft of a map, as 'fathom import --describe' prints it");
  return std::make_unique<recordings::PartedImport>(source.topics(), tables::parse_streams(draft, "draft map"),
                                                    simulated, false);
}

void add_runs(recordings::ImportedFiles imported, const Source& source, FromSource& out) {
  out.notes.insert(out.notes.end(), imported.notes.begin(), imported.notes.end());
  for (recordings::ImportedRun& run : imported.runs) {
    for (const std::string& note : run.notes) out.notes.push_back(source.files.front() + ": " + note);
    if (imported.runs.size() == 1) run.recording.name = source.name;
    out.runs.push_back(std::move(run.recording));
  }
}

FromSource read_source(const Source& source, const std::string& map,
                       const std::optional<tables::SimulatedAxes>& simulated) {
  FromSource out;
  std::string path = source.files.front();
  std::optional<RestoredLog> restored;
  if (!source.channels.empty() && map.empty()) {
    restored.emplace(source);
    if (!restored->note().empty()) out.notes.push_back(path + ": " + restored->note());
    path = restored->path();
  } else if (source.channels.size() > 1) {
    throw InputError(path + ": these are channels of one log, which need no --map; or give one table alone");
  }
  if (source.lcm || restored) {
    wire::LogContents contents = wire::read_log(path);
    std::istringstream lines{wire::complaints(path, contents.report)};
    for (std::string line; std::getline(lines, line);) out.notes.push_back(line);
    out.runs.push_back(std::move(contents.recording));
    out.runs.back().name = source.name;
    return out;
  }
  if (source.is_table() || !source.channels.empty()) {
    tables::Imported imported = tables::import_csv(path, map, simulated);
    for (const std::string& note : imported.notes) out.notes.push_back(path + ": " + note);
    out.runs.push_back(std::move(imported.recording));
    return out;
  }
  add_runs(parted_import(source, map, simulated, out.notes)->all(), source, out);
  return out;
}

namespace {

recordings::Commanded::By commanded_by(model::CommandKind kind, bool by_pulses) {
  using By = recordings::Commanded::By;
  switch (kind) {
    case model::CommandKind::kForce:
      return by_pulses ? By::kPulses : By::kForce;
    case model::CommandKind::kShaftSpeed:
      return By::kShaftSpeed;
    case model::CommandKind::kFinAngle:
    case model::CommandKind::kAzimuthAngle:
      return By::kAngle;
    case model::CommandKind::kAzimuthForce:
    case model::CommandKind::kWeight:
      break;
  }
  return By::kOther;
}

}  // namespace

std::string describe_source(const Source& source, const std::optional<model::Vehicle>& vehicle) {
  if (source.is_table()) {
    std::vector<recordings::Commanded> actuators;
    if (vehicle) {
      for (const model::Thruster& one : vehicle->thrusters)
        actuators.push_back({one.name, commanded_by(one.command, !vehicle->curve.empty())});
    }
    return recordings::describe_table(tables::read_csv(source.files.front()), actuators);
  }
  if (source.format == nullptr && !source.types)
    throw InputError(source.files.front() + ": --describe is for recordings with topics; " +
                     (source.lcm ? "an LCM log of Fathom is read by 'fathom check' and the others as it is; for one of "
                                   "another project give the files that define its types: --types FILE.lcm"
                                 : "tables of a log's channels are the log again, without a map"));
  const recordings::Content content = look_at(source);
  std::string text = recordings::description(content);
  const std::string draft = recordings::draft_map(content);
  if (draft.empty())
    return text + "# None of the topics is a usual one: a map must be written by hand (docs/configuration.md).\n";
  const auto simulated = vehicle ? std::optional<tables::SimulatedAxes>{vehicle->dof} : std::nullopt;
  recordings::PartedImport import{source.topics(), tables::parse_streams(draft, "draft map"), simulated, false};
  if (import.recordings() == 1) {
    recordings::Worth worth;
    for (Recording part; import.next(kRowsAtOnce, part); part = {}) worth.take(part);
    const std::vector<std::string> notes = import.finish();
    for (const std::string& reason : worth.against_fitting()) text += "# ! " + reason + "\n";
    for (const std::string& note : notes) text += "# " + note + "\n";
  } else {
    for (const recordings::ImportedRun& run : import.all().runs) {
      const std::string name = run.recording.name + ": ";
      for (const std::string& reason : recordings::against_fitting(run.recording))
        text += "# ! " + name + reason + "\n";
      for (const std::string& note : run.notes) text += "# " + name + note + "\n";
    }
  }
  return text + "#\n# A draft of a map, which runs as it is. Remarks say what must be checked.\n" + draft;
}

void refuse_over(const std::string& out, const std::string& read) {
  std::error_code unknown;
  if (std::filesystem::equivalent(out, read, unknown))
    throw InputError(out + ": --out is the run itself, which is read from; give what is written another name");
}

}  // namespace fathom::tool
