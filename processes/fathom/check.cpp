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
#include "common/consistency/summary.hpp"
#include "common/estimation/corrections_file.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/estimation/split.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/site.hpp"
#include "common/recordings/worth.hpp"
#include "common/report/json.hpp"
#include "common/runtime/command_line.hpp"
#include "common/tables/writer.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/mended_map.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

struct CheckOptions {
  std::string vehicle, site, map, write, write_map, json;
  std::vector<std::string> runs;
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

void run_check(const CheckOptions& options) {
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  std::vector<std::string> notes, reasons;
  if (const std::string note = model::undriven_note(vehicle); !note.empty()) notes.push_back(note);
  const std::vector<std::string> runs = paths_of(options.runs);
  if (!options.json.empty()) {
    for (const std::string& run : runs) refuse_over(options.json, run);
  }
  std::optional<ProgressLine> shown{std::in_place};
  const Progress progress = shown->progress();
  progress.begin("reading", "reading recordings");
  std::vector<Recording> recordings = read_recordings(runs, options.map, notes, vehicle.dof);
  for (const Recording& recording : recordings) {
    for (const std::string& reason : recordings::against_fitting(recording))
      reasons.push_back(recording.name + ": ! " + reason);
  }
  progress.begin("sensors", "comparing the sensors with each other");
  const std::vector<ConsistencyFinding> dead = consistency::set_aside_dead_axes(recordings, vehicle.dof);
  consistency::ConsistencyResult result = consistency::check_consistency(recordings);
  result.findings.insert(result.findings.begin(), dead.begin(), dead.end());
  consistency::check_thrusters(recordings, vehicle, result);
  if (!options.site.empty()) {
    consistency::check_flow(recordings, vehicle.mounts, model::Site::load(options.site), result);
  }
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (recordings[i].thrusters.empty()) continue;  // sensors alone can be compared too
    try {
      const Trial trial = estimation::reconstruct(recordings[i], result.corrections[i], vehicle);
      std::ranges::copy(estimation::gap_findings({&trial, 1}), std::back_inserter(result.findings));
    } catch (const InputError& error) {  // what fathom diagnose would say of it
      notes.push_back(std::string{"not looked for gaps: "} + error.what());
    }
  }
  shown.reset();
  for (const std::string& note : notes) std::fprintf(stderr, "%s\n", note.c_str());
  for (const std::string& reason : reasons) std::printf("%s\n", reason.c_str());
  notes.insert(notes.end(), reasons.begin(), reasons.end());
  consistency::keep_axes(result, vehicle.dof);
  for (const std::string& line : consistency::table_of(result)) std::printf("%s\n", line.c_str());
  if (result.findings.empty()) {
    std::printf("%s\n", consistency::conclusion_of(result).c_str());
  } else {
    print(result.findings);
  }
  if (!options.json.empty()) {
    report::CheckGiven given{.vehicle = vehicle.name, .compared = consistency::table_of(result), .notes = notes};
    for (const Recording& recording : recordings) given.runs.push_back(recording.name);
    given.findings = result.findings;
    if (given.findings.empty()) given.conclusion = consistency::conclusion_of(result);
    tables::write_file(options.json, report::check_json(given));
  }
  if (!options.write_map.empty()) {
    for (const std::string& note : write_mended_map(options.write_map, options.map, runs, result.corrections))
      std::printf("%s: %s\n", options.write_map.c_str(), note.c_str());
    std::printf("%s: the map as it should be\n", options.write_map.c_str());
  }
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
  std::printf("%s: corrections of %zu of %zu recordings\n", options.write.c_str(), shared.count, recordings.size());
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
  command->callback([options] { run_check(*options); });
}

}  // namespace fathom::tool
