// fathom import: a table of numbers to an LCM log, each stream on the channel that a driver would use.
#include "common/tables/import.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "common/base/error.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/vehicle.hpp"
#include "common/wire/log_writer.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

struct Options {
  std::string data, map, vehicle, out;
};

void run(const Options& options) {
  std::optional<tables::SimulatedAxes> simulated;
  if (!options.vehicle.empty()) {
    const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
    simulated = vehicle.dof;
    if (const std::string note = model::undriven_note(vehicle); !note.empty()) std::printf("%s\n", note.c_str());
  }
  const tables::Imported imported = tables::import_csv(options.data, options.map, simulated);
  for (const std::string& note : imported.notes) std::printf("%s: %s\n", options.data.c_str(), note.c_str());
  const std::uint64_t events = wire::write_log(imported.recording, options.out);
  std::printf("%s: %llu messages (%s)\n", options.out.c_str(), static_cast<unsigned long long>(events),
              counts(imported.recording).c_str());
}

}  // namespace

void add_import(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("import", "CSV to an LCM log");
  command->add_option("data", options->data, "CSV file")->required();
  command->add_option("--map", options->map, "YAML file that says what each column is; without: canonical columns");
  command->add_option("--vehicle", options->vehicle,
                      "vehicle file: columns of axes that it does not simulate may lack");
  command->add_option("--out", options->out, "log to write, RUN.lcmlog")->required();
  command->callback([options] { run(*options); });
}

}  // namespace fathom::tool
