#include "processes/fathom/bus/trial_files.hpp"

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/vehicle.hpp"
#include "common/runtime/command_line.hpp"

namespace fathom::tool {

void add_trial_files(runtime::CommandLine& command, TrialFileOptions& options) {
  command.add_option("--config", options.config,
                     "pipeline file (YAML) with a section estimator, of whichever filter; else what the log tells");
  command.add_option("--vehicle", options.vehicle, "vehicle file (YAML): where instruments sit");
  command.add_option("--site", options.site, "site file (YAML): tags, transponders, floor, walls");
}

estimation::TrialFiles trial_files(const TrialFileOptions& options, const Recording& recording,
                                   std::vector<std::string>& notes) {
  estimation::TrialFiles files = estimation::files_in(recording);
  if (files.in_the_log) {
    std::string told;
    const auto add = [&told](bool there, const char* what) {
      if (there) told += (told.empty() ? "" : ", ") + std::string{what};
    };
    add(files.estimator && options.config.empty(), "instruments' noises");
    add(files.mounts && options.vehicle.empty(), "places on the vehicle");
    add(files.site && options.site.empty(), "the site");
    if (!told.empty()) notes.push_back(recording.name + ": as the log's estimator told: " + told);
  }
  if (!options.config.empty()) {
    const Config config = Config::load(options.config);
    static_cast<void>(config.section("estimator"));  // a file without one is a mistake
    files.add(config);
  }
  if (!options.vehicle.empty()) {
    static_cast<void>(
        model::Vehicle::load(options.vehicle));  // a mistake anywhere in it is one, whatever is taken of it
    const Config vehicle = Config::load(options.vehicle);
    files.mounts = vehicle.is_section("sensors") ? model::Mounts::from(vehicle.section("sensors")) : model::Mounts{};
  }
  if (!options.site.empty()) files.site = model::Site::load(options.site);
  return files;
}

}  // namespace fathom::tool
