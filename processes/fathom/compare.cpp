// fathom compare: do two logs end with the same model?
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "common/base/error.hpp"
#include "common/wire/log_reader.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

struct Options {
  std::string first, second;
};

ModelEstimate last_model(const std::string& path) {
  const Recording recording = wire::read_log(path).recording;
  if (recording.model.empty()) throw InputError(path + ": no MODEL in this log; record the identifier too");
  return recording.model.back();
}

void run(const Options& options) {
  const ModelEstimate a = last_model(options.first), b = last_model(options.second);
  if (a.parameters.size() != b.parameters.size()) throw InputError("the two models have different parameters");
  bool equal = a.utime == b.utime && a.updates == b.updates;
  std::printf("%-10s %14s %14s  %s\n", "parameter", "first", "second", "unit");
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const NamedValue &x = a.parameters[i], &y = b.parameters[i];
    const bool same = x.name == y.name && x.value == y.value && x.std == y.std;
    equal = equal && same;
    std::printf("%-10s %14.7g %14.7g  %s%s\n", x.name.c_str(), x.value, y.value, x.unit.c_str(),
                same ? "" : "  DIFFERENT");
  }
  std::printf("%lld and %lld updates\n", static_cast<long long>(a.updates), static_cast<long long>(b.updates));
  if (!equal) throw InputError(options.first + " and " + options.second + " do not end with the same model");
  std::printf("equal to the last bit\n");
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compare", "do two logs end with the same MODEL?");
  command->add_option("first", options->first, "LCM log")->required();
  command->add_option("second", options->second, "LCM log")->required();
  command->callback([options] { run(*options); });
}

}  // namespace fathom::tool
