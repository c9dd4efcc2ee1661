// fathom trial: the log of a live trial as a verdict table, result.json and a page with the paper's figures.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/estimation/online/navigator.hpp"
#include "common/report/live/live_trial.hpp"
#include "common/runtime/command_line.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/log_reader.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/origin.hpp"

namespace fathom::tool {
namespace {

constexpr std::size_t kSheet = 12;  // pictures

struct TrialOptions {
  std::string log, vehicle, site, pipeline, diagnosis, truth, out;
};

void save(const std::string& path, const std::string& text) {
  std::ofstream file{path, std::ios::binary};
  file << text;
  if (!file.flush()) throw InputError(path + ": cannot be written; check the folder's permissions and free space");
}

/// Of the complementary filters; none for another one.
std::optional<estimation::NavigatorSettings> filters_in(const std::string& pipeline) {
  if (pipeline.empty()) return std::nullopt;
  const Config config = Config::load(pipeline).section("estimator");
  if (!config.has("filter") || config.text("filter") != "complementary") return std::nullopt;
  return estimation::NavigatorSettings::from(config);
}

ResultOrigin origin_of(const TrialOptions& options, const Recording& recording) {
  ResultOrigin origin{.command = "fathom trial", .files = {}};
  add_recording(origin, "log", options.log, {&recording, 1});
  add_words(origin, "", options.log);
  const std::pair<const char*, const std::string&> files[] = {
      {"vehicle", options.vehicle}, {"site", options.site}, {"pipeline", options.pipeline}, {"truth", options.truth}};
  for (const auto& [role, path] : files) {
    add_file(origin, role, path);
    add_words(origin, std::string{"--"} + role, path);
  }
  if (!options.diagnosis.empty()) add_file(origin, "diagnosis", options.diagnosis + "/result.json");
  add_words(origin, "--diagnosis", options.diagnosis);
  return origin;
}

void run_trial(const TrialOptions& options) {
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  const model::Site site = model::Site::load(options.site);
  const auto filters = filters_in(options.pipeline);
  const wire::LogContents contents = wire::read_log(options.log);
  const std::string complaints = wire::complaints(options.log, contents.report);
  if (!complaints.empty()) std::fprintf(stderr, "note: %s", complaints.c_str());
  LiveTrialResult result = report::summarise(contents.recording, vehicle, site);
  std::error_code failed;
  std::filesystem::create_directories(options.out, failed);
  if (failed) throw InputError(options.out + ": cannot be made (" + failed.message() + "); choose another --out");
  if (!options.diagnosis.empty()) {
    const auto beside = std::filesystem::path{options.diagnosis}.lexically_proximate(options.out) / "report.html";
    result.afterwards = report::read_afterwards(options.diagnosis, beside.generic_string());
  }
  if (!options.truth.empty()) result.truth = report::compare_truth(options.truth, contents.recording);
  save(options.out + "/result.json", report::to_json(result, origin_of(options, contents.recording)));
  save(options.out + "/report.html",
       report::to_html(result, contents.recording, vehicle, site,
                       wire::read_pictures(options.log, wire::kCameraDebug, kSheet), filters ? &*filters : nullptr));
  std::printf("%s\nresult %s/result.json\nreport %s/report.html\n", report::to_table(result).c_str(),
              options.out.c_str(), options.out.c_str());
}

}  // namespace

void add_trial(runtime::CommandLine& app) {
  auto options = std::make_shared<TrialOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("trial", "what a live trial's log holds: modes, parameters, figures");
  command->add_option("log", options->log, "log of the trial (.lcmlog)")->required();
  command->add_option("--vehicle", options->vehicle, "vehicle file (YAML)")->required();
  command->add_option("--site", options->site, "site file (YAML)")->required();
  command->add_option("--pipeline", options->pipeline, "the estimator's file (YAML), for Figures 1.4 and 1.5");
  command->add_option("--diagnosis", options->diagnosis, "folder that fathom diagnose wrote for the same log");
  command->add_option("--truth", options->truth, "the simulator's truth.json, for a section of its own");
  command->add_option("--out", options->out, "folder for result.json and report.html")->required();
  command->callback([options] { run_trial(*options); });
}

}  // namespace fathom::tool
