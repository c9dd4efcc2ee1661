// fathom doctor: is this host ready for a trial?
#include "processes/fathom/bus/doctor.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "common/base/error.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

struct DoctorOptions {
  std::string url{"udpm://239.255.76.67:7667?ttl=0"};
  std::vector<std::string> config;
  std::string folder{"."}, operator_file;
};

const char* word(Finding::Grade grade) {
  if (grade == Finding::Grade::kWell) return "ok";
  return grade == Finding::Grade::kBad ? "BAD" : "note";
}

void run_doctor(const DoctorOptions& options) {
  std::vector<Finding> all = check_programs();
  const auto add = [&](const std::vector<Finding>& more) { all.insert(all.end(), more.begin(), more.end()); };
  add(check_network(options.url));
  add(check_buffers());
  all.push_back(check_clock());
  all.push_back(check_disk(options.folder));
  for (const std::string& each : options.config) add(check_devices(each));
  if (!options.operator_file.empty()) all.push_back(check_operator(options.operator_file));
  int bad = 0;
  for (const Finding& each : all) {
    bad += each.grade == Finding::Grade::kBad ? 1 : 0;
    std::printf("%-4s  %-12s %s%s%s\n", word(each.grade), each.what.c_str(), each.found.c_str(),
                each.mend.empty() ? "" : "; ", each.mend.c_str());
  }
  if (bad > 0) throw InputError("doctor: " + std::to_string(bad) + " of " + std::to_string(all.size()) + " are bad");
}

}  // namespace

void add_doctor(runtime::CommandLine& app) {
  auto options = std::make_shared<DoctorOptions>();
  if (const char* url = std::getenv("LCM_DEFAULT_URL"); url != nullptr && *url != '\0') options->url = url;
  if (const char* run = std::getenv("FATHOM_RUN"); run != nullptr && *run != '\0') options->folder = run;
  if (const char* file = std::getenv("FATHOM_OPERATOR"); file != nullptr) options->operator_file = file;
  runtime::CommandLine* command =
      app.add_subcommand("doctor", "is this host ready: programs, network, buffers, clock, disk, devices");
  command->add_option("--bus", options->url, "LCM URL (LCM_DEFAULT_URL)");
  command->add_option("--config", options->config, "the drivers' file: are its devices there and ours?");
  command->add_option("--run", options->folder, "folder for the trial's logs (FATHOM_RUN)");
  command->add_option("--operator", options->operator_file, "the operator's file (FATHOM_OPERATOR)");
  command->callback([options] { run_doctor(*options); });
}

}  // namespace fathom::tool
