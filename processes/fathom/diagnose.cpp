// fathom diagnose: closes the loop on recordings. Sensors are checked, the base model fitted, its residual traced to
// effects that it lacks, and the error before and after reported on runs that no fit has seen.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/consistency/dead_axes.hpp"
#include "common/consistency/flow_check.hpp"
#include "common/consistency/thruster_clock.hpp"
#include "common/diagnosis/diagnoser.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/estimation/shared_clock.hpp"
#include "common/estimation/split.hpp"
#include "common/estimation/state_as_measured.hpp"
#include "common/estimation/wording.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/site.hpp"
#include "common/preflight/force_unit.hpp"
#include "common/preflight/implausible.hpp"
#include "common/preflight/sensor_faults.hpp"
#include "common/recordings/worth.hpp"
#include "common/report/folds.hpp"
#include "common/report/report.hpp"
#include "common/report/table.hpp"
#include "common/result/causes.hpp"
#include "common/runtime/command_line.hpp"
#include "common/verdict/by_likelihood.hpp"
#include "processes/fathom/command_units.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/origin.hpp"
#include "processes/fathom/parts.hpp"
#include "processes/fathom/recordings.hpp"
#include "processes/fathom/rehearsals.hpp"
#include "processes/fathom/search_progress.hpp"
#include "processes/fathom/separations.hpp"

namespace fathom::tool {
namespace {

constexpr const char* kTrajectories = "trajectories";
constexpr const char* kLikelihood = "likelihood";
constexpr double kHeldOut = 0.3;   // of every run, when no validation run is given
constexpr double kShortest = 2.0;  // s between two gaps: the search looks at windows of that length
constexpr double kNotable = 0.05;  // of the recordings left out: the reader should know
// Of what judges: what begins later is seen for too short a time if half of it is fitted.
constexpr double kTooLate = 0.3;

/// Phases of the work beside those of the diagnosis.
constexpr std::string_view kReading = "reading", kSensors = "sensors", kReconstruction = "reconstruction",
                           kReport = "report", kDiagnosis = "diagnosis";
constexpr double kLight = 0.03;             // of a fit: reading or reconstructing a run, until it has been timed
constexpr double kGuessedDiagnosis = 40.0;  // fits, until it says more itself

struct DiagnoseOptions {
  std::string vehicle, map, out, site, config;
  std::vector<std::string> train, validate;
  std::vector<std::string> without;
  std::string core{kTrajectories};
  bool no_learning{false};
  int threads{2};
  double time_budget{std::numeric_limits<double>::infinity()};
  double held{static_cast<double>(kMostHeld) / 1e6};  // MB of samples of a recording
  int folds{0};
};

void check_names(const std::vector<std::string>& without) {
  const std::vector<std::string> listed = inference::listed_names();
  for (const std::string& name : without) {
    if (std::ranges::find(listed, name) != listed.end()) continue;
    std::string all;
    for (const std::string& one : listed) all += (all.empty() ? "" : ", ") + one;
    throw InputError("--without " + name + ": no effect has this name; listed are " + all);
  }
}

void make_folder(const std::string& path) {  // before the long work, so that a bad path costs nothing
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw InputError(path + ": cannot make this folder: " + error.message() + "; give another --out");
}

/// Complaints about a recording begin with its name; people look for the file.
Trial reconstruct(const std::string& path, const Recording& recording, const estimation::Corrections& corrections,
                  const model::Vehicle& vehicle) {
  try {
    return estimation::reconstruct(recording, corrections, vehicle);
  } catch (const InputError& error) {
    const std::string what = error.what(), name = recording.name + ": ";
    throw InputError(path + ": " + (what.starts_with(name) ? what.substr(name.size()) : what));
  }
}

/// Stretches of all runs over which it is known what drove the vehicle. InputError where no gap leaves `needed` s.
class Stretches {
 public:
  /// The runs are taken apart: what they held is not held twice.
  Stretches(std::vector<Trial> runs, std::span<const std::string> paths, double needed) {
    double longest = 0.0, lost = 0.0;
    std::size_t gaps = 0;
    const bool several = runs.size() > 1;
    for (Trial& run : runs) {
      whole_ += duration(run);
      gaps += estimation::input_gaps(run).count;
      lost += estimation::input_gaps(run).total;
      for (Trial& stretch : estimation::known_stretches(std::exchange(run, {}), kShortest)) {
        longest = std::max(longest, duration(stretch));
        kept_ += duration(stretch);
        trials_.push_back(std::move(stretch));
      }
    }
    if (gaps == 0 || longest > needed) return;
    throw InputError(paths.front() + (several ? " and its fellows" : "") +
                     estimation::text(": what drove the vehicle is missing for %.3g s of %.4g s", lost, whole_) +
                     estimation::text(", and no stretch of %.3g s is left between the %.0f gaps", needed,
                                      static_cast<double>(gaps)) +
                     "; record motion and thrusters together without pauses, or log at a steady rate");
  }
  [[nodiscard]] const std::vector<Trial>& trials() const { return trials_; }
  [[nodiscard]] double whole() const { return whole_; }
  [[nodiscard]] double left_out() const { return whole_ - kept_; }

 private:
  static double duration(const Trial& trial) { return static_cast<double>(trial.size()) * trial.dt; }

  std::vector<Trial> trials_;
  double whole_{}, kept_{};  // s
};

/// One reading of the recordings and what it came to.
struct Explained {
  std::optional<Stretches> fitting, judging;
  std::vector<ConsistencyFinding> gaps;
  identification::FitResult fitted;
  DiagnosisReport report;
  VerdictGiven given;
};

/// True when the event begins within the first `share` of the run that it begins in.
bool begins_before(const UnseenEvent& event, std::span<const Trial> runs, double share) {
  double first = 0.0, last = 0.0;
  for (const Trial& run : runs) {
    if (run.name != event.run) continue;
    if (last == 0.0) first = run.t.front();
    last = run.t.back();
  }
  return event.t < first + share * (last - first);
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
  if (options.core != kTrajectories) add_words(origin, "--core", options.core);
  add_words(origin, "--without", options.without);
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

DiagnosisReport diagnose(const DiagnoseOptions& options, std::vector<std::string>& notes, const Progress& progress,
                         VerdictGiven& given, ResultOrigin& origin) {
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  check_command_units(options.map, vehicle);
  if (const std::string note = model::undriven_note(vehicle); !note.empty()) notes.push_back(note);
  std::optional<planning::RehearsalSettings> room;  // read before the long work
  if (!options.site.empty()) room = rehearsal_settings(options.site, options.config, vehicle);
  check_names(options.without);
  if (!options.without.empty() && options.core != kLikelihood)
    throw InputError("--without takes effects out of the list of --core likelihood alone; give that too");
  if (options.no_learning && options.core != kLikelihood)
    throw InputError("--no-learning is about --core likelihood alone; give that too");
  make_folder(options.out);
  const auto files = static_cast<double>(paths_of(options.train).size() + paths_of(options.validate).size());
  progress.expect(kReading, files, kLight);
  progress.expect(kSensors, 1, kLight * files);
  progress.expect(kReconstruction, files, kLight);
  progress.expect(kReport, 1, 1.0);
  progress.expect(kDiagnosis, 1, kGuessedDiagnosis);
  progress.begin(kReading, "reading recordings");
  Looked looked = look_at(options, vehicle, notes);
  origin = origin_of(options, looked);
  std::vector<Recording> recordings = std::move(looked.recordings);
  const std::vector<std::string>& paths = looked.paths;
  const std::size_t fitted_runs = looked.fitted;
  const auto runs = static_cast<double>(paths.size());
  for (const Recording& recording : recordings) {
    for (const std::string& reason : recordings::against_fitting(recording))
      notes.push_back(recording.name + ": ! " + reason);
  }

  progress.done(kReading, files);
  progress.begin(kSensors, "comparing the sensors with each other");
  const std::vector<ConsistencyFinding> dead = consistency::set_aside_dead_axes(recordings, vehicle.dof);
  consistency::ConsistencyResult consistency = consistency::check_consistency(recordings);
  consistency.findings.insert(consistency.findings.begin(), dead.begin(), dead.end());
  consistency::check_thrusters(recordings, vehicle, consistency);
  if (!options.site.empty()) {
    consistency::check_flow(recordings, vehicle.mounts, model::Site::load(options.site), consistency);
  }

  progress.done(kSensors);
  // Samples are let go while their trials are searched, and read again in the rare case that they are needed again.
  const auto trials_of_recordings = [&] {
    if (recordings.empty()) {
      std::vector<std::string> told_already;
      recordings = look_at(options, vehicle, told_already).recordings;
      static_cast<void>(consistency::set_aside_dead_axes(recordings, vehicle.dof));
      if (!options.site.empty()) {
        consistency::ConsistencyResult found_already = consistency;
        consistency::check_flow(recordings, vehicle.mounts, model::Site::load(options.site), found_already);
      }
    }
    std::vector<Trial> trials;
    progress.expect(kReconstruction, runs, kLight);
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      progress.begin(kReconstruction, "reconstructing " + recordings[i].name);
      trials.push_back(reconstruct(paths[i], recordings[i], consistency.corrections[i], vehicle));
      progress.done(kReconstruction);
    }
    return trials;
  };
  diagnosis::Settings settings;
  settings.threads = options.threads;
  if (options.validate.empty()) settings.held_out = kHeldOut;
  bool told = false;
  const auto explain = [&](std::vector<Trial> trials, Explained& out, estimation::Kept kept) {
    const bool one_clock = estimation::share_clock(recordings, trials);
    if (one_clock && !std::exchange(told, true))
      notes.emplace_back("the recordings follow one another on one clock: what begins in one goes on in the next");
    recordings = {};
    out.gaps = estimation::gap_findings(trials);
    std::vector<Trial> train, validate;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (options.validate.empty()) {
        estimation::Parts parts = estimation::split(std::exchange(trials[i], {}), kHeldOut, kept);
        train.push_back(std::move(parts.fitted));
        std::ranges::move(parts.judged, std::back_inserter(validate));
      } else {
        (i < fitted_runs ? train : validate).push_back(std::move(trials[i]));
      }
    }
    out.fitting.emplace(std::move(train), paths, settings.fit.window);
    out.judging.emplace(std::move(validate), std::span{paths}.subspan(options.validate.empty() ? 0 : fitted_runs),
                        kShortest);
    progress.expect(kDiagnosis, 0);
    if (options.core == kLikelihood) {
      verdict::Answer answer = verdict::diagnose(
          vehicle, out.fitting->trials(), out.judging->trials(),
          {.without = options.without, .threads = options.threads, .time_budget = options.time_budget}, progress,
          {.learn = !options.no_learning});
      out.report = std::move(answer.report);
      out.given = std::move(answer.given);
      return;
    }
    SearchProgress search{progress};
    out.report = diagnosis::diagnose(vehicle, out.fitting->trials(), out.judging->trials(), settings, std::ref(search),
                                     &out.fitted);
    search.end();
  };
  if (options.validate.empty()) {
    notes.emplace_back("no --validate: the last 30 % of every run is kept from the fits and used to judge them");
  }
  Explained explained;
  explain(trials_of_recordings(), explained, estimation::Kept::kLast);
  if (preflight::thrust_as_late_as_gyro(explained.report.result, consistency.findings)) {
    consistency::put_thrusters_on_pose_clock(consistency);
    explain(trials_of_recordings(), explained, estimation::Kept::kLast);
  }
  if (options.validate.empty() && explained.report.unseen_event) {
    const UnseenEvent event = *explained.report.unseen_event;
    const bool early = begins_before(event, explained.judging->trials(), kTooLate);
    Explained again;
    try {
      explain(trials_of_recordings(), again, early ? estimation::Kept::kEnds : estimation::Kept::kFirst);
    } catch (const InputError& error) {  // of these parts alone: what the first look has found stands
      notes.push_back(estimation::text("something begins near %.0f s, too late for what is fitted; ", event.t) +
                      "other parts cannot judge: " + error.what());
    }
    if (!again.report.result.effects.empty() && !again.report.unseen_event) {
      notes.push_back(estimation::text("something begins near %.0f s, too late for what is fitted: ", event.t) +
                      (early ? "the first and the last 15 % of every run judge" : "the first 30 % of every run judge") +
                      " in place of the last 30 %");
      explained = std::move(again);
    }
  }
  DiagnosisReport& report = explained.report;
  const Stretches &fitting = *explained.fitting, &judging = *explained.judging;
  if (room && options.core == kTrajectories)
    separate(vehicle, *room, fitting.trials(), explained.fitted, report.result);
  report.result.consistency = std::move(consistency.findings);
  report.result.consistency.insert(report.result.consistency.end(), explained.gaps.begin(), explained.gaps.end());
  preflight::adopt_sensor_faults(report.result);
  if (auto finding = preflight::compare_inertia(vehicle, report.result.parameters_after))
    report.result.consistency.push_back(*std::move(finding));
  std::ranges::move(preflight::implausible_numbers(vehicle, report.result.parameters_after),
                    std::back_inserter(report.result.consistency));
  const double left_out = (fitting.left_out() + judging.left_out()) / (fitting.whole() + judging.whole());
  if (left_out > kNotable) {
    report.result.paragraph += estimation::text(
        " %.0f %% of the recordings was left out: what drove the vehicle was not recorded there.", 100.0 * left_out);
  }
  given = std::move(explained.given);
  if (options.core == kTrajectories) {
    given.causes = result::causes_of(report.result);
    result::put_covariance(explained.fitted, given);
  }
  return std::move(explained.report);
}

DiagnosisResult run_once(const DiagnoseOptions& options) {
  std::vector<std::string> notes;
  DiagnosisReport report;
  VerdictGiven given;
  ResultOrigin origin;
  report::Written written;
  double elapsed = 0.0;
  {
    ProgressLine line;
    const Progress progress = line.progress();
    report = diagnose(options, notes, progress, given, origin);
    progress.begin(kReport, "drawing the report");
    written = report::write(report, options.out, given, origin);
    elapsed = line.elapsed();
  }
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
  std::printf("%s\nresult %s\nreport %s\ntook   %.1f s\n", report::to_table(report.result).c_str(),
              written.json.c_str(), written.html.c_str(), elapsed);
  return std::move(report.result);
}

void run_diagnose(const DiagnoseOptions& options) {
  if (options.folds == 0) {
    static_cast<void>(run_once(options));
    return;
  }
  if (!options.validate.empty())
    throw InputError("--folds holds recordings out by itself; give all of them to --train, and no --validate");
  std::vector<DiagnosisResult> results;
  for (const report::Fold& fold : report::folds_of(paths_of(options.train), options.folds)) {
    DiagnoseOptions one = options;
    one.train = fold.fitted;
    one.validate = fold.held_out;
    one.out = options.out + "/fold-" + std::to_string(results.size() + 1);
    std::printf("fold %zu: %zu recordings fitted, %zu held out\n", results.size() + 1, fold.fitted.size(),
                fold.held_out.size());
    results.push_back(run_once(one));
  }
  std::printf("\n%s", report::fold_table(results).c_str());
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
                   "trajectories: windows of open-loop rollouts; likelihood: an innovations filter over whole runs")
      ->one_of({kTrajectories, kLikelihood});
  command->add_option("--without", options->without,
                      "with --core likelihood: effects to take out of the list, by name");
  command
      ->add_option("--time-budget", options->time_budget,
                   "with --core likelihood: s for the search; what is not asked by then is said to be open")
      ->within(1.0, 1e6);
  command->add_flag("--no-learning", options->no_learning,
                    "with --core likelihood: what no listed effect explains is told, and no force is learned from it");
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
