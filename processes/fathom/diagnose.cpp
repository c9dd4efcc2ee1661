// fathom diagnose: closes the loop on recordings. Sensors are checked, the base model fitted, its residual traced to
// effects that it lacks, and the error before and after reported on runs that no fit has seen.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/estimation/smoothing/state_as_measured.hpp"
#include "common/inference/ablations.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/site.hpp"
#include "common/recordings/worth.hpp"
#include "common/report/folds.hpp"
#include "common/report/report.hpp"
#include "common/report/table.hpp"
#include "common/runtime/command_line.hpp"
#include "common/verdict/of_recordings.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/data/command_units.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/origin.hpp"
#include "processes/fathom/parts.hpp"
#include "processes/fathom/recordings.hpp"
#include "processes/fathom/rehearsals.hpp"
#include "processes/fathom/separations.hpp"

namespace fathom::tool {
namespace {

constexpr const char* kLikelihood = "likelihood";

/// Phases of the work beside those of the diagnosis.
constexpr std::string_view kReading = "reading", kReport = "report";
constexpr double kLight = 0.03;  // of a fit: reading a run, until it has been timed

struct DiagnoseOptions {
  std::string vehicle, map, out, site, config;
  std::vector<std::string> train, validate;
  std::vector<std::string> without, candidates, ablated;
  std::string core{kLikelihood};
  bool no_learning{false};
  int threads{2};
  double time_budget{std::numeric_limits<double>::infinity()};
  double held{static_cast<double>(kMostHeld) / 1e6};  // MB of samples of a recording
  int folds{0};
};

void check_names(const std::vector<std::string>& without, const model::Vehicle& vehicle) {
  std::vector<std::string> listed = inference::listed_names();
  for (const model::Candidate& candidate : vehicle.candidates) listed.push_back(model::effect_name(candidate));
  for (const std::string& name : without) {
    if (std::ranges::find(listed, name) != listed.end()) continue;
    std::string all;
    for (const std::string& one : listed) all += (all.empty() ? "" : ", ") + one;
    throw InputError("--without " + name + ": no effect has this name; listed are " + all);
  }
}

/// Before the long work, so that a bad path costs nothing. Nothing is left of the try: who is refused or stopped finds
/// no empty folder.
void try_folder(const std::string& path) {
  namespace fs = std::filesystem;
  std::vector<fs::path> missing;  // the deepest first
  std::error_code error, ignored;
  for (fs::path at = fs::absolute(path).lexically_normal(); !fs::exists(at, ignored) && at.has_relative_path();
       at = at.parent_path())
    missing.push_back(at);
  fs::create_directories(path, error);
  for (const fs::path& made : missing) fs::remove(made, ignored);  // never one with something in it
  if (error) throw InputError(path + ": cannot make this folder: " + error.message() + "; give another --out");
}

/// Recordings as they are looked at: sorted by time, a long one in stretches.
struct Looked {
  std::vector<Recording> recordings;
  std::vector<std::string> paths;  ///< of each
  std::size_t fitted{};            ///< the first so many are fitted
};

Looked look_at(const DiagnoseOptions& options, const model::Vehicle& vehicle, std::vector<std::string>& notes) {
  std::vector<std::string> given = paths_of(options.train);
  const std::size_t trained = given.size();
  std::ranges::move(paths_of(options.validate), std::back_inserter(given));
  Stretched read = read_stretches(
      given, {.map = options.map, .simulated = vehicle.dof, .most = static_cast<std::size_t>(options.held * 1e6)},
      notes);
  Looked looked{.recordings = std::move(read.recordings), .paths = {}, .fitted = 0};
  for (const std::size_t run : read.run) {
    looked.paths.push_back(given[run]);
    looked.fitted += run < trained ? 1 : 0;
  }
  const auto sort = [&](std::size_t from, std::size_t count) {
    sort_by_time(std::span{looked.recordings}.subspan(from, count), std::span{looked.paths}.subspan(from, count));
  };
  sort(0, looked.fitted);
  sort(looked.fitted, looked.paths.size() - looked.fitted);
  for (Recording& recording : looked.recordings) {
    if (!estimation::take_state_as_measured(recording)) continue;
    notes.push_back(recording.name + ": no motion capture; the estimator's STATE is taken in its place");
  }
  return looked;
}

/// Hashes of all that is read, and the command with the recordings in the order of their time.
ResultOrigin origin_of(const DiagnoseOptions& options, const Looked& looked) {
  ResultOrigin origin{.command = "fathom diagnose", .files = {}};
  add_file(origin, "vehicle", options.vehicle);
  add_file(origin, "map", options.map);
  add_file(origin, "site", options.site);
  add_file(origin, "config", options.config);
  std::vector<std::string> train, validate;
  for (std::size_t i = 0, end = 0; i < looked.paths.size(); i = end) {  // stretches of one file stand together
    const bool fitted = i < looked.fitted;
    const std::string& path = looked.paths[i];
    while (end < looked.paths.size() && looked.paths[end] == path && (end < looked.fitted) == fitted) ++end;
    (fitted ? train : validate).push_back(path);
    add_recording(origin, fitted ? "train" : "validate", path, std::span{looked.recordings}.subspan(i, end - i));
  }
  add_words(origin, "--vehicle", options.vehicle);
  add_words(origin, "--map", options.map);
  add_words(origin, "--site", options.site);
  add_words(origin, "--config", options.config);
  add_words(origin, "--without", options.without);
  add_words(origin, "--candidate", options.candidates);
  add_words(origin, "--ablate", options.ablated);
  const auto add_number = [&](const char* option, double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.17g", value);
    add_words(origin, option, std::string{text.data()});
  };
  if (std::isfinite(options.time_budget)) add_number("--time-budget", options.time_budget);
  if (options.held != DiagnoseOptions{}.held) add_number("--memory", options.held);
  if (options.no_learning) origin.command += " --no-learning";
  add_words(origin, "--train", train);
  add_words(origin, "--validate", validate);
  return origin;
}

verdict::Answer diagnose(const DiagnoseOptions& options, std::vector<std::string>& notes, const Progress& progress,
                         ResultOrigin& origin) {
  model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  for (const std::string& text : options.candidates) model::add_candidate(text, vehicle.candidates);
  check_command_units(options.map, vehicle);
  if (const std::string note = model::undriven_note(vehicle); !note.empty()) notes.push_back(note);
  std::optional<model::Site> site;  // both are read before the long work
  std::optional<planning::RehearsalSettings> room;
  if (!options.site.empty()) {
    site = model::Site::load(options.site);
    room = rehearsal_settings(options.site, options.config, vehicle);
  }
  check_names(options.without, vehicle);
  inference::Settings inference{
      .without = options.without, .threads = options.threads, .time_budget = options.time_budget};
  for (const std::string& name : options.ablated) inference::ablate(name, inference);
  try_folder(options.out);
  const auto files = static_cast<double>(paths_of(options.train).size() + paths_of(options.validate).size());
  progress.expect(kReading, files, kLight);
  progress.expect(kReport, 1, 1.0);
  progress.begin(kReading, "reading recordings");
  Looked looked = look_at(options, vehicle, notes);
  origin = origin_of(options, looked);
  for (const Recording& recording : looked.recordings) {
    for (const std::string& reason : recordings::against_fitting(recording))
      notes.push_back(recording.name + ": ! " + reason);
  }
  progress.done(kReading, files);
  verdict::Asked asked{.recordings = std::move(looked.recordings),
                       .fitted = looked.fitted,
                       .called = std::move(looked.paths),
                       .again = [&options, &vehicle] {
                         std::vector<std::string> told_already;
                         return look_at(options, vehicle, told_already).recordings;
                       }};
  if (options.validate.empty())
    notes.emplace_back("no --validate: the last 30 % of every run is kept from the fits and used to judge them");
  verdict::Explained explained = verdict::of_recordings(
      vehicle, std::move(asked),
      {.inference = std::move(inference), .learning = {.learn = !options.no_learning}, .site = site ? &*site : nullptr},
      progress, notes);
  if (room && explained.answer.rivals) {
    const model::Model best =
        likelihood::model_of(explained.answer.best.hypothesis, explained.fitted.front().input_step);
    separate(vehicle, *room, explained.fitted, best, explained.answer.report.result);
  }
  return std::move(explained.answer);
}

struct Done {
  DiagnosisResult result;
  bool ran{true};  ///< false: the filter did not run through the data, and the page says so
};

Done run_once(const DiagnoseOptions& options) {
  std::vector<std::string> notes;
  verdict::Answer answer;
  ResultOrigin origin;
  report::Written written;
  double elapsed = 0.0;
  {
    ProgressLine line;
    const Progress progress = line.progress();
    answer = diagnose(options, notes, progress, origin);
    progress.begin(kReport, "drawing the report");
    written = report::write(answer.report, options.out, answer.given, origin);
    elapsed = line.elapsed();
  }
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
  std::printf("%s\nresult %s\nreport %s\ntook   %.1f s\n", report::to_table(answer.report.result).c_str(),
              written.json.c_str(), written.html.c_str(), elapsed);
  const bool ran = std::ranges::none_of(answer.given.causes, [](const auto& cause) {
    return cause.cause == inference::word(inference::Cause::kNotFinite);
  });
  return {std::move(answer.report.result), ran};
}

void refuse_unless(bool ran) {
  if (!ran)
    throw InputError(
        "nothing was judged: the filter did not run through this data; compare the units and sizes in the vehicle file "
        "(mass, thrust, hull) with the craft, and try 'fathom check' on the recordings");
}

void run_diagnose(const DiagnoseOptions& options) {
  if (options.folds == 0) {
    refuse_unless(run_once(options).ran);
    return;
  }
  if (!options.validate.empty())
    throw InputError("--folds holds recordings out by itself; give all of them to --train, and no --validate");
  std::vector<DiagnosisResult> results;
  bool ran = true;
  for (const report::Fold& fold : report::folds_of(paths_of(options.train), options.folds)) {
    DiagnoseOptions one = options;
    one.train = fold.fitted;
    one.validate = fold.held_out;
    one.out = options.out + "/fold-" + std::to_string(results.size() + 1);
    std::printf("fold %zu: %zu recordings fitted, %zu held out\n", results.size() + 1, fold.fitted.size(),
                fold.held_out.size());
    Done done = run_once(one);
    ran = ran && done.ran;
    results.push_back(std::move(done.result));
  }
  std::printf("\n%s", report::fold_table(results).c_str());
  refuse_unless(ran);
}

}  // namespace

void add_diagnose(runtime::CommandLine& app) {
  auto options = std::make_shared<DiagnoseOptions>();
  runtime::CommandLine* command = app.add_subcommand("diagnose", "find what a vehicle's model lacks");
  command->add_option("--vehicle", options->vehicle, "vehicle file (YAML)")->required();
  command->add_option("--train", options->train, "recordings to fit: files, folders or patterns")->required();
  command->add_option(
      "--validate", options->validate,
      "recordings to judge by; without: the last 30 % of every run, or other parts when something begins there");
  command
      ->add_option("--folds", options->folds,
                   "judge every recording once, by what is found on the others: in this many parts, each a diagnosis "
                   "in a folder of its own")
      ->within(2, 100);
  command->add_option("--map", options->map, "YAML file that says what the columns of .csv files are");
  command->add_option("--site", options->site,
                      "site file: what to fly there to tell look-alikes apart is computed, and optical flow is "
                      "compared with the tags of its map");
  command->add_option("--config", options->config, "with --site: pipeline file (its namesake in ../pipelines/)");
  command
      ->add_option("--core", options->core,
                   "likelihood, an innovations filter over whole runs, is the only one; for scripts that say so")
      ->one_of({kLikelihood});
  command->add_option("--without", options->without, "effects to take out of the list, by name");
  command->add_option("--candidate", options->candidates,
                      "measured columns that a force may go with, as wind_speed^2 or voltage*tau_X; along a measured "
                      "bearing: wind_speed^2 @ wind_direction");
  command->add_option("--ablate", options->ablated,
                      "rules or terms of the inference to leave out, to measure what they are good for");
  command
      ->add_option("--time-budget", options->time_budget,
                   "s for the search; what is not asked by then is said to be open")
      ->within(1.0, 1e6);
  command->add_flag("--no-learning", options->no_learning,
                    "what no listed effect explains is told, and no force is learned from it");
  command
      ->add_option("--memory", options->held,
                   "MB of samples of a recording that are looked at; of one that takes more, stretches spread evenly "
                   "over it")
      ->within(1.0, 1e6);
  command->add_option("--out", options->out, "folder for result.json and report.html")->required();
  command->add_option("--threads", options->threads, "threads of the fits; the result does not depend on it")
      ->within(1, 64);
  command->callback([options] { run_diagnose(*options); });
}

}  // namespace fathom::tool
