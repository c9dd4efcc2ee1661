// fathom check: do the sensors of these recordings agree with each other? Nothing is fitted.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/consistency/consistency.hpp"
#include "common/consistency/dead_axes.hpp"
#include "common/consistency/flow_check.hpp"
#include "common/consistency/merged.hpp"
#include "common/consistency/summary.hpp"
#include "common/estimation/corrections_file.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/estimation/smoothing/trial_instruments.hpp"
#include "common/estimation/split.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/site.hpp"
#include "common/recordings/worth.hpp"
#include "common/report/json.hpp"
#include "common/runtime/command_line.hpp"
#include "common/tables/writer.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/data/command_units.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/mended_map.hpp"
#include "processes/fathom/parts.hpp"

namespace fathom::tool {
namespace {

struct CheckOptions {
  std::string vehicle, site, map, write, write_map, json;
  std::vector<std::string> runs;
  double held{static_cast<double>(kMostHeld) / 1e6};  // MB of samples in memory
};

void print(const std::vector<ConsistencyFinding>& findings) {
  std::printf("%-12s %-14s %-14s %-12s %12s  %s\n", "run", "signal", "against", "finding", "size", "what is done");
  for (const ConsistencyFinding& one : findings) {
    char size[32];
    std::snprintf(size, sizeof size, "%.4g %s", one.size, one.unit.c_str());
    std::printf("%-12s %-14s %-14s %-12s %12s  %s\n", one.run.c_str(), one.signal.c_str(), one.reference.c_str(),
                one.finding.c_str(), size, one.action.c_str());
    std::printf("%-12s   %s\n", "", one.evidence.c_str());
  }
}

/// Recordings, or parts of one, on their way through the check. Of samples no more is held than of one group.
class Checking {
 public:
  Checking(const model::Vehicle& vehicle, const std::string& site, std::vector<std::string> runs)
      : vehicle_{vehicle}, runs_{std::move(runs)}, worth_(runs_.size()), merged_{runs_} {
    if (!site.empty()) site_ = model::Site::load(site);
  }

  void take(std::vector<RunPart>& group) {
    std::vector<Recording> recordings;
    std::vector<consistency::CheckedPart> parts;
    for (RunPart& one : group) {
      worth_[one.run].take(one.recording);
      parts.push_back({one.recording.name, one.run});
      recordings.push_back(std::move(one.recording));
    }
    const std::vector<ConsistencyFinding> dead = consistency::set_aside_dead_axes(recordings, vehicle_.dof);
    consistency::ConsistencyResult result = consistency::check_consistency(recordings);
    result.findings.insert(result.findings.begin(), dead.begin(), dead.end());
    consistency::check_thrusters(recordings, vehicle_, result);
    if (!site_) take_site(recordings);
    if (site_) consistency::check_flow(recordings, vehicle_.mounts, *site_, result);
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      if (recordings[i].thrusters.empty()) continue;  // sensors alone can be compared too
      try {
        const Trial trial = estimation::reconstruct(recordings[i], result.corrections[i], vehicle_);
        std::ranges::copy(estimation::gap_findings({&trial, 1}), std::back_inserter(result.findings));
      } catch (const InputError& error) {  // what fathom diagnose would say of it
        const std::string note = std::string{"not looked for gaps: "} + error.what();
        if (std::ranges::find(notes_, note) == notes_.end()) notes_.push_back(note);
      }
    }
    merged_.add(std::move(result), parts);
  }

  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] std::vector<std::string> reasons() const {
    std::vector<std::string> reasons;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      for (const std::string& reason : worth_[i].against_fitting()) reasons.push_back(runs_[i] + ": ! " + reason);
    }
    return reasons;
  }
  [[nodiscard]] const std::vector<std::string>& runs() const { return runs_; }
  [[nodiscard]] std::size_t checks() const { return merged_.checks(); }
  [[nodiscard]] consistency::ConsistencyResult result() { return std::move(merged_).result(); }

 private:
  /// A log of Fathom's own tells where it was.
  void take_site(const std::vector<Recording>& recordings) {
    for (const Recording& one : recordings) {
      if (one.optical_flow.empty()) continue;
      site_ = estimation::files_in(one).site;
      if (!site_) continue;
      notes_.push_back(one.name + ": optical flow is compared with the tags of the site that the log's estimator told");
      return;
    }
  }

  const model::Vehicle& vehicle_;
  std::vector<std::string> runs_;
  std::optional<model::Site> site_;
  std::vector<recordings::Worth> worth_;  ///< of every run
  std::vector<std::string> notes_;
  consistency::Merged merged_;
};

void run_check(const CheckOptions& options) {
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  check_command_units(options.map, vehicle);
  std::vector<std::string> notes;
  if (const std::string note = model::undriven_note(vehicle); !note.empty()) notes.push_back(note);
  const std::vector<std::string> runs = paths_of(options.runs);
  if (!options.json.empty()) {
    for (const std::string& run : runs) refuse_over(options.json, run);
  }
  Checking checking{vehicle, options.site, names_of_runs(runs)};
  std::optional<ProgressLine> shown{std::in_place};
  const Progress progress = shown->progress();
  progress.begin("reading", "reading recordings");
  GroupOptions in_memory{.map = options.map, .simulated = vehicle.dof};
  in_memory.most = static_cast<std::size_t>(options.held * 1e6);
  in_groups(runs, in_memory, notes, [&](std::vector<RunPart>& group) {
    progress.begin("sensors", "comparing the sensors of " + group.front().recording.name + " with each other");
    checking.take(group);
    progress.begin("reading", "reading recordings");
  });
  notes.insert(notes.end(), checking.notes().begin(), checking.notes().end());
  if (checking.checks() > 1) {
    notes.push_back("looked at in " + std::to_string(checking.checks()) +
                    " parts, one after the other: all samples together would not fit into memory");
  }
  const std::vector<std::string> reasons = checking.reasons();
  consistency::ConsistencyResult result = checking.result();
  shown.reset();
  for (const std::string& note : notes) std::fprintf(stderr, "%s\n", note.c_str());
  for (const std::string& reason : reasons) std::printf("%s\n", reason.c_str());
  notes.insert(notes.end(), reasons.begin(), reasons.end());
  consistency::keep_axes(result, vehicle.dof);
  for (const std::string& line : consistency::table_of(result)) std::printf("%s\n", line.c_str());
  const bool compared = !result.findings.empty() || !consistency::table_of(result).empty();
  if (result.findings.empty() && compared) std::printf("%s\n", consistency::conclusion_of(result).c_str());
  if (!result.findings.empty()) print(result.findings);
  if (!options.json.empty()) {
    report::CheckGiven given{.vehicle = vehicle.name, .compared = consistency::table_of(result), .notes = notes};
    given.runs = checking.runs();
    given.findings = result.findings;
    if (given.findings.empty()) given.conclusion = consistency::conclusion_of(result);
    tables::write_file(options.json, report::check_json(given));
  }
  if (!options.write_map.empty()) {
    for (const std::string& note : write_mended_map(options.write_map, options.map, runs, result.corrections))
      std::printf("%s: %s\n", options.write_map.c_str(), note.c_str());
    std::printf("%s: the map as it should be\n", options.write_map.c_str());
  }
  std::fflush(stdout);  // what was said of the runs stands before the complaint
  if (!compared) throw InputError(runs.front() + ": " + consistency::conclusion_of(result));
  if (options.write.empty()) return;
  for (const estimation::Corrections& one : result.corrections) {
    if (one.velocity_frame == estimation::VectorFrame::kBody && one.rates_frame == estimation::VectorFrame::kBody &&
        one.position_late == 0.0)
      continue;
    throw InputError(
        "--write: vectors along the world's axes, and a position that is late by itself, cannot be corrected "
        "live; mend their driver or map first (--write-map)");
  }
  const estimation::Shared shared = estimation::most_shared(result.corrections);
  tables::write_file(options.write, estimation::to_yaml(shared.corrections));
  std::printf("%s: corrections of %zu of %zu recordings\n", options.write.c_str(), shared.count,
              result.corrections.size());
}

}  // namespace

void add_check(runtime::CommandLine& app) {
  auto options = std::make_shared<CheckOptions>();
  runtime::CommandLine* command = app.add_subcommand("check", "compare the sensors of recordings with each other");
  command->add_option("--vehicle", options->vehicle, "vehicle file (YAML)")->required();
  command->add_option("--site", options->site,
                      "site file (YAML): optical flow is compared with the tags of its map, too");
  command->add_option("runs", options->runs, "recordings: files, folders or patterns")->required();
  command->add_option("--map", options->map, "YAML file that says what the columns of .csv files are");
  command->add_option("--write-map", options->write_map,
                      "write the map of the tables as it should be to this file: conventions, heading, unit");
  command->add_option("--json", options->json, "write what was found to this file (docs/schema/check-1.schema.json)");
  command->add_option("--write", options->write, "write the corrections for live processes to this file");
  command
      ->add_option("--memory", options->held,
                   "MB of samples that are held at a time; a recording that takes more is looked at part by part")
      ->within(1.0, 1e6);
  command->callback([options] { run_check(*options); });
}

}  // namespace fathom::tool
