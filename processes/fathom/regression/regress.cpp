// fathom regress: hydrodynamic derivatives from reconstructed trials, printed as Pereira and Duncan's Tables 1 to 6.
#include <cstdio>
#include <memory>
#include <set>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/motions.hpp"
#include "common/report/text.hpp"
#include "common/runtime/command_line.hpp"
#include "common/tables/writer.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/recordings.hpp"
#include "processes/fathom/regression/regress_json.hpp"
#include "processes/fathom/regression/regress_page.hpp"
#include "processes/fathom/regression/regress_trace.hpp"
#include "processes/fathom/smoothing.hpp"

namespace fathom::tool {
namespace {

using identification::AxisRegression;
using identification::StepwiseResult;

struct RegressOptions {
  TrialFileOptions files;  // of runs that are not smoothed yet
  std::string map, write, json, page;
  std::vector<std::string> runs;
  std::vector<double> current;
  double rate{10.0};
  double significance{0.05}, f_in{}, f_out{}, cell_gain{3.0}, thrust_gain{10.0};
  bool table{false}, estimate{false}, plain{false}, trace{false};
};

std::string cell(const StepwiseResult& result, int column) {
  for (std::size_t i = 0; i < result.terms.size(); ++i) {
    const auto& term = result.terms[i];
    if (term.column != column) continue;
    char text[64];
    std::snprintf(text, sizeof text, "%9.4f%s %4.0f%%%s", term.value,
                  static_cast<int>(i) == result.most_significant ? "*" : " ", term.percent(), term.stands() ? "" : "?");
    return text;
  }
  return "";
}

void print(const AxisRegression& axis, const std::vector<identification::ManoeuvreRows>& runs,
           const model::Vehicle& vehicle) {
  std::printf(
      "\n%s (%s): dimensionless, standard error in per cent, * most significant, ? within its errors, or another would "
      "do\n%-10s",
      model::kAxisNames[static_cast<std::size_t>(axis.axis)], kMotionNames[static_cast<std::size_t>(axis.axis)], "");
  for (const auto& run : runs) std::printf(" | %17.17s", run.name.c_str());
  if (runs.size() > 1) std::printf(" | %17s", "together");
  std::printf(" | %17s\n", "reference");
  std::set<int> shown;
  for (const StepwiseResult& one : axis.manoeuvres) {
    for (const auto& term : one.terms) shown.insert(term.column);
  }
  for (const auto& term : axis.together.terms) shown.insert(term.column);
  for (std::size_t j = 0; j < axis.candidates.terms.size(); ++j) {
    std::string reference;
    for (const auto& known : vehicle.hydrodynamics->reference) {
      if (known.term != axis.candidates.terms[j]) continue;
      char text[64];
      std::snprintf(text, sizeof text, "%9.4f  %4.0f%%", known.value, 100.0 * known.error / std::abs(known.value));
      reference = text;
    }
    if (reference.empty() && !shown.contains(static_cast<int>(j))) continue;
    std::printf("%-10s", axis.candidates.names[j].c_str());
    for (const StepwiseResult& one : axis.manoeuvres) std::printf(" | %17s", cell(one, static_cast<int>(j)).c_str());
    if (runs.size() > 1) std::printf(" | %17s", cell(axis.together, static_cast<int>(j)).c_str());
    std::printf(" | %17s\n", reference.c_str());
  }
}

void print_quality(const AxisRegression& axis, const std::vector<identification::ManoeuvreRows>& runs) {
  const auto line = [&](const char* name, const StepwiseResult& one) {
    std::printf(
        "  %-14.14s phi %.4f +- %.4f, residual %.3g white, %d samples of which %.0f independent, explained %.1f %%, "
        "cross-validated %.1f %%\n",
        name, one.phi, one.phi_sigma, one.sigma, one.samples, one.effective_samples, 100.0 * one.explained,
        100.0 * one.cross_validated);
    for (const auto& term : one.terms) {
      if (term.equivalents.empty()) continue;
      std::printf("    %s or, as well:", axis.candidates.names[static_cast<std::size_t>(term.column)].c_str());
      for (const int column : term.equivalents)
        std::printf(" %s", axis.candidates.names[static_cast<std::size_t>(column)].c_str());
      std::printf("\n");
    }
    for (const auto& refused : one.refused) {
      std::printf("    %s: %s\n", axis.candidates.names[static_cast<std::size_t>(refused.column)].c_str(),
                  refused.why.c_str());
    }
  };
  for (std::size_t i = 0; i < runs.size(); ++i) line(runs[i].name.c_str(), axis.manoeuvres[i]);
  if (runs.size() > 1) line("together", axis.together);
}

std::string coefficients_of(const std::vector<AxisRegression>& axes) {
  std::string text = "# Written by fathom regress.\ncoefficients:\n";
  for (const AxisRegression& axis : axes) {
    for (const auto& term : axis.together.terms) {
      char line[160];
      std::snprintf(line, sizeof line, "  \"%s\": {value: %.6g, error: %.3g %%}\n",
                    axis.candidates.names[static_cast<std::size_t>(term.column)].c_str(), term.value, term.percent());
      text += line;
    }
  }
  return text;
}

/// A run with SMOOTHED: as it was read, else smoothed first. What a page tells of its motion goes to `motion`.
Recording with_smoothed(Recording recording, const RegressOptions& options, report::Album& album, std::string& motion) {
  report::Smoothing smoothing;
  if (recording.smoothed.empty()) {
    std::fprintf(stderr, "%s: no SMOOTHED in it; smoothed first, as fathom smooth does\n", recording.name.c_str());
    auto run = smoothed_run(std::move(recording), options.files, {.filtered = !options.page.empty()}, {});
    recording = std::move(run.recording);
    smoothing = smoothing_of(std::move(run.found));
  }
  if (!options.page.empty()) motion += report::smoothed_section(recording, smoothing, album);
  return recording;
}

identification::RegressionSettings settings_of(const RegressOptions& options) {
  identification::RegressionSettings settings;
  settings.rate = options.rate;
  settings.cell_gain = 0.01 * options.cell_gain;
  settings.thrust_gain = 0.01 * options.thrust_gain;
  settings.stepwise.familywise = options.significance;
  if (options.f_out > 0.0 && !(options.f_in >= options.f_out))
    throw InputError("--f-out must not exceed --f-in, or a term would leave as soon as it has entered");
  if (options.f_in > 0.0) {
    settings.stepwise.f_in = options.f_in;
    settings.stepwise.f_out = options.f_out > 0.0 ? options.f_out : options.f_in;
  }
  settings.stepwise.autoregressive = settings.stepwise.effective_samples = !options.plain;
  if (options.current.size() == 2) settings.v_WF << options.current[0], options.current[1], 0.0;
  return settings;
}

void run_regress(const RegressOptions& options) {
  identification::RegressionSettings settings = settings_of(options);
  const model::Vehicle vehicle = model::Vehicle::load(options.files.vehicle);
  std::vector<std::string> notes;
  std::vector<identification::ManoeuvreRows> runs;
  report::Album album;
  std::string motion;
  std::vector<Recording> recordings = read_recordings(options.runs, options.map, notes, vehicle.dof);
  identification::need_hydrodynamics(vehicle);
  for (const std::string& note : std::exchange(notes, {})) std::fprintf(stderr, "%s\n", note.c_str());
  for (Recording& one : recordings) {
    const Recording recording = with_smoothed(std::move(one), options, album, motion);
    runs.push_back(identification::rows_of(recording, vehicle, options.rate));
    if (const double unsure = runs.back().unsure; unsure > 0.0)
      notes.push_back(recording.name + ": " + report::number(unsure, 2) +
                      " s left out, where the smoother is less than half as sure as mostly: its ends, lost aids");
    if (runs.back().stretches.size() > 1) {
      notes.push_back(recording.name + ": cut at gaps into " + std::to_string(runs.back().stretches.size()) +
                      " stretches");
    }
  }
  if (options.estimate) {
    settings.v_WF = identification::estimate_current(vehicle, runs, settings);
    char text[100];
    std::snprintf(text, sizeof text, "water moves north %.3f, east %.3f m/s (estimated)", settings.v_WF.x(),
                  settings.v_WF.y());
    notes.emplace_back(text);
  }
  for (const std::string& note : notes) std::fprintf(stderr, "%s\n", note.c_str());
  const std::vector<AxisRegression> axes = identification::regress(vehicle, runs, settings);
  if (!options.table) std::printf("forces from %s; rows of %.3g s\n", runs.front().known_from.c_str(), runs.front().dt);
  for (const AxisRegression& axis : axes) {
    print(axis, runs, vehicle);
    if (!options.table) print_quality(axis, runs);
  }
  std::vector<identification::TracedPull> traced;
  if (options.trace || !options.page.empty()) traced = identification::trace_pulls(vehicle, runs, settings);
  if (options.trace) print_trace(traced);
  if (!options.write.empty()) tables::write_file(options.write, coefficients_of(axes));
  if (!options.json.empty()) tables::write_file(options.json, regression_json(axes, runs, vehicle, settings));
  if (!options.page.empty()) {
    const std::string more = trace_section(traced, album) + motion;
    tables::write_file(options.page, album.fill(regress_page(axes, runs, vehicle, settings, more), "gnuplot"));
  }
}

}  // namespace

void add_regress(runtime::CommandLine& app) {
  auto options = std::make_shared<RegressOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("regress", "hydrodynamic derivatives from recorded runs, term by term");
  command
      ->add_option("runs", options->runs, "one per manoeuvre: what fathom smooth wrote, or recordings, smoothed first")
      ->required();
  command->add_option("--vehicle", options->files.vehicle, "vehicle file (YAML) with hydrodynamics")->required();
  command->add_option("--config", options->files.config,
                      "to smooth by: pipeline file (YAML) with a section estimator; else what the log tells");
  command->add_option("--site", options->files.site, "to smooth by: site file (YAML) with tags, transponders, floor");
  command->add_option("--map", options->map, "YAML file that says what the columns of .csv files are");
  command->add_flag("--table", options->table, "the tables alone");
  command->add_option("--rate", options->rate, "rows per second")->positive();
  command->add_option("--current", options->current, "north and east velocity of the water [m/s]")->expected(2);
  command->add_flag("--estimate-current", options->estimate, "find the water's velocity as well");
  command->add_flag("--plain", options->plain, "plain least squares, as if the residual were white");
  command->add_flag("--trace", options->trace, "whence the residual comes: umbilical and chain, known and not");
  command->add_option("--significance", options->significance, "chance that any term is selected when none acts")
      ->within(1e-12, 1.0);
  command->add_option("--f-in", options->f_in, "F from which a term enters, in place of --significance")->positive();
  command->add_option("--f-out", options->f_out, "F below which a term leaves; --f-in without it")->positive();
  command->add_option("--cell-gain", options->cell_gain, "per cent by which a load cell's gain may be off (std)")
      ->positive();
  command->add_option("--thrust-gain", options->thrust_gain, "the same of a thruster's force without a cell")
      ->positive();
  command->add_option("--json", options->json, "write all that is told to this file");
  command->add_option(
      "--page", options->page,
      "HTML file to write: derivatives with their intervals, whence the residual comes, every run drawn");
  command->add_option("--write", options->write, "write the derivatives of all runs together to this YAML file");
  command->callback([options] { run_regress(*options); });
}

}  // namespace fathom::tool
