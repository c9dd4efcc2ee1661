// fathom info, fathom export: what a log holds; its channels for other programs, and an identified model for other
// simulators.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/file_hash.hpp"
#include "common/exports/log_export.hpp"
#include "common/exports/models/formats.hpp"
#include "common/model/vehicle.hpp"
#include "common/runtime/command_line.hpp"
#include "common/wire/log_writer.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

struct ExportOptions {
  std::string input, to, out, vehicle, config, map;
  std::vector<std::string> channels;
};

void print_counts(const exports::Exported& exported) {
  for (const auto& [channel, count] : exported.written)
    std::printf("%-18s %llu messages\n", channel.c_str(), static_cast<unsigned long long>(count));
  for (const auto& [channel, count] : exported.damaged)
    std::fprintf(stderr, "note: %s: %llu messages were damaged and are left out\n", channel.c_str(),
                 static_cast<unsigned long long>(count));
  for (const auto& [channel, count] : exported.unknown)
    std::fprintf(stderr, "note: %s: %llu messages of a type that this version does not have are left out\n",
                 channel.c_str(), static_cast<unsigned long long>(count));
  if (!exported.warning.empty()) std::fprintf(stderr, "note: %s\n", exported.warning.c_str());
}

std::string text_of(const std::string& path) {
  std::ifstream file{path, std::ios::binary};
  if (!file) throw InputError(path + ": cannot be read");
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// The vehicle's file: as given, else where the diagnosis read it. Says so where it is no longer the same.
std::string vehicle_of(const result::Stored& stored, const std::string& given) {
  const auto listed = std::ranges::find(stored.origin.files, "vehicle", &OriginFile::role);
  const bool known = listed != stored.origin.files.end();
  if (given.empty() && !known)
    throw InputError(stored.path + ": does not say which vehicle file it rests on; give it with --vehicle");
  const std::string path = given.empty() ? listed->path : given;
  if (!std::filesystem::exists(path))
    throw InputError(path +
                     ": is not there any more, and the diagnosis rests on it; give the vehicle's file with --vehicle");
  if (known && hash_of_file(path).sha256 != listed->sha256)
    std::fprintf(
        stderr,
        "note: %s is not what the diagnosis read (%s): its mass, thrusters and density are taken as they are now\n",
        path.c_str(), listed->path.c_str());
  return path;
}

void export_model(const ExportOptions& options) {
  const result::Stored stored = result::read_result(options.input);
  const std::string path = vehicle_of(stored, options.vehicle);
  const exports::Craft craft = exports::craft_of(stored, model::Vehicle::load(path));
  const exports::ModelFile file = exports::model_file(options.to, craft, stored, text_of(path));
  const std::string out = options.out.empty() ? exports::identifier(craft.name) + "." + file.extension : options.out;
  refuse_over(out, path);
  refuse_over(out, stored.path);
  std::ofstream into{out, std::ios::binary};
  into << file.text;
  if (!into.flush()) throw InputError(out + ": cannot be written; check the folder's permissions and free space");
  for (const std::string& note : file.unsaid) std::fprintf(stderr, "note: %s\n", note.c_str());
  std::printf("model  %s\n", out.c_str());
}

constexpr std::array kOfLogs{"csv", "mcap", "npz"};

/// An LCM log as it is; any other recording as the log that `fathom import` would make of it, for as long as this
/// lives.
class AsLog {
 public:
  explicit AsLog(const ExportOptions& options) : path_{options.input} {
    const std::vector<Source> sources = sources_of({options.input});
    if (sources.size() == 1 && sources.front().lcm) {
      if (!options.map.empty()) throw InputError("--map is for recordings that are no LCM logs");
      return;
    }
    std::vector<std::string> notes;
    std::optional<tables::SimulatedAxes> simulated;
    if (!options.vehicle.empty()) simulated = model::Vehicle::load(options.vehicle).dof;
    const std::vector<Recording> read = read_recordings({options.input}, options.map, notes, simulated);
    for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
    std::string pattern = (std::filesystem::temp_directory_path() / "fathom-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw InputError(pattern + ": cannot be made; set TMPDIR to a folder that can be written");
    folder_ = pattern;
    path_ = (folder_ / (read.front().name + ".lcmlog")).string();
    static_cast<void>(wire::write_log(read.front(), path_));
  }
  ~AsLog() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  AsLog(const AsLog&) = delete;
  AsLog& operator=(const AsLog&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::filesystem::path folder_;
};

void export_log(const ExportOptions& options) {
  const std::filesystem::path input{options.input};
  const std::string stem = (input.has_filename() ? input : input.parent_path()).stem().string();
  const std::string out = !options.out.empty() ? options.out : stem + (options.to == "csv" ? "_csv" : "." + options.to);
  refuse_over(out, options.input);
  const AsLog log{options};
  const exports::Exported exported = options.to == "csv"    ? exports::to_csv(log.path(), out, options.channels)
                                     : options.to == "mcap" ? exports::to_mcap(log.path(), out, options.channels)
                                                            : exports::to_npz(log.path(), out, options.channels);
  print_counts(exported);
  if (exported.written.empty())
    throw InputError(options.input + ": holds no message of a type that this version has; " + out + " is empty");
  std::printf("%s   %s\n", options.to == "csv" ? "folder" : "file  ", out.c_str());
}

void run_export(const ExportOptions& options) {
  if (std::ranges::find(kOfLogs, options.to) != kOfLogs.end()) {
    export_log(options);
    return;
  }
  if (!options.channels.empty()) throw InputError("--channel is for --to csv, mcap and npz");
  if (!options.map.empty()) throw InputError("--map is for --to csv, mcap and npz");
  export_model(options);
}

void run_info(const ExportOptions& options) {
  const exports::LogSummary summary = exports::summary_of(options.input);
  if (options.config.empty()) {
    std::fputs(exports::words_of(options.input, summary).c_str(), stdout);
    return;
  }
  const auto found = std::ranges::find(summary.processes, options.config, &exports::ProcessSummary::process);
  if (found != summary.processes.end()) {
    std::fputs(found->config.c_str(), stdout);
    return;
  }
  std::string all;
  for (const exports::ProcessSummary& one : summary.processes) all += (all.empty() ? "" : ", ") + one.process;
  throw InputError(options.input + ": no process " + options.config + " has told of itself; " +
                   (all.empty() ? std::string{"none has"} : "these have: " + all));
}

}  // namespace

void add_export(runtime::CommandLine& app) {
  auto options = std::make_shared<ExportOptions>();
  runtime::CommandLine* info =
      app.add_subcommand("info", "what a log holds: channels, types, rates, gaps, embedded configuration");
  info->add_option("log", options->input, "LCM log (.lcmlog)")->required();
  info->add_option("--config", options->config, "print the configuration of this process in place of the table");
  info->callback([options] { run_info(*options); });

  runtime::CommandLine* command =
      app.add_subcommand("export", "a log's channels for other programs, or an identified model for other simulators");
  command
      ->add_option("input", options->input,
                   "any recording (for csv, mcap, npz), or result.json of a diagnosis or its folder")
      ->required();
  command
      ->add_option("--to", options->to, "format; csv, mcap and npz (NumPy) of a recording, the others of a diagnosis")
      ->required()
      ->one_of({"csv", "mcap", "npz", "vehicle", "gz", "uuv", "stonefish", "holoocean", "mss", "json"});
  command->add_option("--out", options->out, "file, or folder for csv; without: named after the input, here");
  command->add_option("--channel", options->channels, "with csv, mcap, npz: these channels alone");
  command->add_option("--vehicle", options->vehicle, "vehicle file; without: the one that the diagnosis read");
  command->add_option("--map", options->map,
                      "YAML file that says what the columns of tables and the topics of logs are");
  command->callback([options] { run_export(*options); });
}

}  // namespace fathom::tool
