// fathom plan: before a trial, what its excitation would tell about every effect, and what to fly in addition.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/base/version.hpp"
#include "common/planning/flights.hpp"
#include "common/planning/foresight.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/rehearsals.hpp"

namespace fathom::tool {
namespace {

using Json = nlohmann::ordered_json;
using planning::Foreseen;

constexpr double kWindow = 10.0;  // s, as in a diagnosis
constexpr double kTold = 2.0;     // times the excitation: an answer that takes longer is none

struct PlanOptions {
  std::string vehicle, site, config, excitation{"paper"}, json;
  double velocity_noise{0.005}, rate_noise{0.0035}, rate{100.0}, longest{600.0};
};

planning::RehearsalSettings settings_from(const PlanOptions& options, const model::Vehicle& vehicle) {
  planning::RehearsalSettings s = rehearsal_settings(options.site, options.config, vehicle);
  s.longest = options.longest;
  s.rate = options.rate;
  s.noise << Eigen::Vector3d::Constant(options.velocity_noise), Eigen::Vector3d::Constant(options.rate_noise);
  s.supervisor.optimal = options.excitation == "optimal";
  if (s.supervisor.optimal) s.supervisor.schedule = {s.supervisor.schedule.back()};
  return s;
}

std::string said(const planning::Answer& answer) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f s of ", answer.seconds);
  return text + answer.segment;
}

std::string size_of(const Foreseen& one) {
  std::string text;
  char number[64];
  for (const NamedValue& value : one.size) {
    std::snprintf(number, sizeof number, "%s%s %.3g%s%s", text.empty() ? "" : ", ", value.name.c_str(), value.value,
                  value.unit.empty() ? "" : " ", value.unit.c_str());
    text += number;
  }
  return text;
}

void print(const std::vector<Foreseen>& all, double duration) {
  std::printf("\n%-22s %7s  %-18s %s\n", "effect", "hidden", "corrupts", "the smallest that would be found");
  for (const Foreseen& one : all) {
    const std::string form = one.form.empty() ? "" : " (" + one.form + ")";
    if (!one.found) {
      std::printf("%-22s %7s  %-18s not at any physical size%s\n", one.name.c_str(), "-", "-", form.c_str());
      continue;
    }
    char corrupts[48];
    std::snprintf(corrupts, sizeof corrupts, "%s %+.0f %%", one.corrupted.c_str(), 100.0 * one.corruption);
    std::printf("%-22s %5.0f %%  %-18s %s%s\n", one.name.c_str(), 100.0 * one.hidden, corrupts, size_of(one).c_str(),
                form.c_str());
    if (one.forms > 1)
      std::printf("%-22s %7s  %-18s of %d forms %d would be found\n", "", "", "", one.forms, one.forms_found);
    if (one.soonest && one.soonest->seconds < duration)
      std::printf("%-22s %7s  %-18s sooner: %s\n", "", "", "", said(*one.soonest).c_str());
    for (const planning::LookAlike& other : one.like) {
      const bool apart = other.told_apart && other.told_apart->seconds < kTold * duration;
      std::printf("%-22s %7s  %-18s not told from %s; %s\n", "", "", "", other.name.c_str(),
                  apart ? ("told apart by " + said(*other.told_apart)).c_str() : "by none of the segments either");
    }
  }
}

Json json_of(const std::optional<planning::Answer>& answer) {
  if (!answer) return nullptr;
  return {{"segment", answer->segment}, {"seconds", answer->seconds}};
}

void write(const PlanOptions& options, const std::vector<Foreseen>& all, const planning::Rehearsal& rehearsal) {
  Json file{{"schema", 1},           {"fathom_version", version()},      {"vehicle", options.vehicle},
            {"site", options.site},  {"excitation", options.excitation}, {"duration_s", rehearsal.trial.t.back()},
            {"ends", rehearsal.end}, {"effects", Json::array()}};
  for (const Foreseen& one : all) {
    Json size = Json::object(), like = Json::array();
    for (const NamedValue& v : one.size) size[v.name] = {{"value", v.value}, {"unit", v.unit}};
    for (const auto& other : one.like)
      like.push_back({{"name", other.name}, {"told_apart_by", json_of(other.told_apart)}});
    file["effects"].push_back({{"name", one.name},
                               {"form", one.form},
                               {"forms", one.forms},
                               {"forms_found", one.forms_found},
                               {"found", one.found},
                               {"smallest_size", size},
                               {"hidden_share", one.hidden},
                               {"corrupts", one.corrupted},
                               {"corruption", one.corruption},
                               {"soonest", json_of(one.soonest)},
                               {"not_told_from", like}});
  }
  std::ofstream out{options.json};
  out << file.dump(2) << "\n";
  if (!out.flush()) throw InputError(options.json + ": cannot be written; check the free space");
}

void run_plan(const PlanOptions& options) {
  // Before the work, not after it.
  if (!options.json.empty()) {
    const bool there = std::filesystem::exists(options.json);
    if (!std::ofstream{options.json, std::ios::app})
      throw InputError(options.json + ": cannot be written; check that the folder exists and is yours");
    if (!there) std::filesystem::remove(options.json);
  }
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  const planning::RehearsalSettings settings = settings_from(options, vehicle);
  ProgressLine line;
  const Progress progress = line.progress();
  constexpr const char* kRehearsal = "rehearsal";
  progress.begin(kRehearsal, "rehearsing the " + options.excitation + " excitation");
  const planning::Rehearsal rehearsal = planning::rehearse(vehicle, settings);
  progress.done(kRehearsal);
  const double duration = rehearsal.trial.t.back();
  const planning::View excitation{vehicle, rehearsal.trial, kWindow};
  const planning::Flights flights{vehicle, excitation, settings, progress};
  const std::vector<Foreseen> all = planning::foresee(vehicle, excitation, flights.extras(), {}, progress);
  std::printf("%s excitation of %s: %.0f s, %s\n", options.excitation.c_str(), vehicle.name.c_str(), duration,
              rehearsal.end.c_str());
  print(all, duration);
  if (!options.json.empty()) write(options, all, rehearsal);
}

}  // namespace

void add_plan(runtime::CommandLine& app) {
  auto options = std::make_shared<PlanOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("plan", "before a trial: what would its excitation tell about every effect?");
  command->add_option("--vehicle", options->vehicle, "vehicle file")->required()->existing_file();
  command->add_option("--site", options->site, "site file")->required()->existing_file();
  command->add_option("--excitation", options->excitation, "paper or optimal")->one_of({"paper", "optimal"});
  command->add_option("--config", options->config, "pipeline file (../pipelines/ beside the site's, of the same name)")
      ->existing_file();
  command->add_option("--velocity-noise", options->velocity_noise, "m/s of a sample (0.005)")->positive();
  command->add_option("--rate-noise", options->rate_noise, "rad/s of a sample (0.0035)")->positive();
  command->add_option("--rate", options->rate, "Hz of samples (100)")->positive();
  command->add_option("--longest", options->longest, "s after which the trial is ended (600)")->positive();
  command->add_option("--json", options->json, "write the plan here too");
  command->callback([options] { run_plan(*options); });
}

}  // namespace fathom::tool
