// fathom compare: do two logs end with the same model, or with --intervals one that agrees? With --manoeuvre: do two
// sets of derivatives fly alike?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "common/base/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/wire/log_reader.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

struct CompareOptions {
  std::string first, second, manoeuvre, plot, vehicle;
  bool intervals{false}, over{false};
  double rudder{20.0};  // deg
};

ModelEstimate last_model(const std::string& path) {
  const Recording recording = wire::read_log(path).recording;
  if (recording.model.empty()) throw InputError(path + ": no MODEL in this log; record the identifier too");
  return recording.model.back();
}

// Two trials of the same vehicle have noise of their own: their 95 % intervals must meet.
void compare_intervals(const ModelEstimate& a, const ModelEstimate& b) {
  std::size_t apart = 0;
  std::printf("%-10s %26s %26s %9s  %s\n", "parameter", "first, 95 %", "second, 95 %", "apart", "unit");
  for (const NamedValue& x : a.parameters) {
    const auto y =
        std::find_if(b.parameters.begin(), b.parameters.end(), [&](const NamedValue& n) { return n.name == x.name; });
    if (y == b.parameters.end()) throw InputError("only the first model has the parameter " + x.name);
    const double sigma = std::hypot(x.std, y->std);
    const double distance = std::abs(x.value - y->value);
    const bool meet = distance <= kNormal95 * (x.std + y->std);
    if (!meet) ++apart;
    std::printf("%-10s %14.5g ± %9.2g %14.5g ± %9.2g %5.2f sig  %s%s\n", x.name.c_str(), x.value, kNormal95 * x.std,
                y->value, kNormal95 * y->std, sigma > 0.0 ? distance / sigma : 0.0, x.unit.c_str(),
                meet ? "" : "  INTERVALS DO NOT MEET");
  }
  std::printf("%zu of %zu parameters agree within their intervals\n", a.parameters.size() - apart, a.parameters.size());
  if (apart > 0) throw InputError("the two models do not agree within their intervals");
}

void run_compare(const CompareOptions& options) {
  if (!options.manoeuvre.empty()) {
    compare_manoeuvre({.first = options.first,
                       .second = options.second,
                       .name = options.manoeuvre,
                       .plot = options.plot,
                       .vehicle = options.vehicle,
                       .over = options.over,
                       .rudder = options.rudder});
    return;
  }
  const ModelEstimate a = last_model(options.first), b = last_model(options.second);
  if (options.intervals) return compare_intervals(a, b);
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

void add_compare(runtime::CommandLine& app) {
  auto options = std::make_shared<CompareOptions>();
  runtime::CommandLine* command =
      app.add_subcommand("compare", "do two logs end with the same MODEL, or do two vehicles fly a manoeuvre alike?");
  command->add_option("first", options->first, "LCM log; with --manoeuvre a vehicle file")->required();
  command->add_option("second", options->second, "LCM log; with --manoeuvre a vehicle file, or coefficients alone")
      ->required();
  command->add_flag("--intervals", options->intervals, "not the same bits: do the parameters' 95 % intervals meet?");
  command->add_option("--manoeuvre", options->manoeuvre, "line, zigzag or circle: fly both and compare");
  command->add_option("--vehicle", options->vehicle, "of --manoeuvre: whose coefficients both files are");
  command->add_flag("--over", options->over, "coefficients alone: over the vehicle's own, which fill what they lack");
  command->add_option("--rudder", options->rudder, "of --manoeuvre: deg, of craft that steer by rudders")
      ->within(1.0, 60.0);
  command->add_option("--plot", options->plot, "write the two tracks of the manoeuvre to this SVG file");
  command->callback([options] { run_compare(*options); });
}

}  // namespace fathom::tool
