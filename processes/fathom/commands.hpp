// The subcommands of the offline tool. Each adds itself to the command line; what it does runs after parsing.
#pragma once

#include <string>

namespace fathom::runtime {
class CommandLine;
}

namespace fathom::tool {

void add_import(runtime::CommandLine& app);
void add_check(runtime::CommandLine& app);
void add_diagnose(runtime::CommandLine& app);
void add_compare(runtime::CommandLine& app);
void add_smooth(runtime::CommandLine& app);
void add_regress(runtime::CommandLine& app);
void add_methods(runtime::CommandLine& app);
void add_plan(runtime::CommandLine& app);

/// Two vehicle files flown through one manoeuvre, or files of coefficients: for `vehicle`, or for the first one's.
struct ManoeuvreComparison {
  std::string first, second, name, plot, vehicle;
  bool over{false};     ///< coefficients stand over the vehicle's own, which fill the gaps of an incomplete set
  double rudder{20.0};  ///< deg, of who steers by rudders; its zigzag turns back at the same heading
};
void compare_manoeuvre(const ManoeuvreComparison& asked);
void add_decode(runtime::CommandLine& app);
void add_emulate(runtime::CommandLine& app);
void add_operator(runtime::CommandLine& app);
void add_doctor(runtime::CommandLine& app);
void add_repair_log(runtime::CommandLine& app);
void add_pictures(runtime::CommandLine& app);
void add_trial(runtime::CommandLine& app);
void add_watch(runtime::CommandLine& app);
void add_bus(runtime::CommandLine& app);
void add_spy(runtime::CommandLine& app);
void add_vehicle(runtime::CommandLine& app);
void add_explain(runtime::CommandLine& app);
void add_export(runtime::CommandLine& app);
/// To commands that are there already.
void add_examples(runtime::CommandLine& app);

}  // namespace fathom::tool
