// The subcommands of the offline tool. Each adds itself to the command line; what it does runs after parsing.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace fathom::tool {

void add_import(CLI::App& app);
void add_check(CLI::App& app);
void add_diagnose(CLI::App& app);
void add_compare(CLI::App& app);
void add_smooth(CLI::App& app);
void add_regress(CLI::App& app);
void add_methods(CLI::App& app);
void add_plan(CLI::App& app);

/// Two vehicle files flown through one manoeuvre; the second may be a file of coefficients for the first one's vehicle.
void compare_manoeuvre(const std::string& first, const std::string& second, const std::string& name,
                       const std::string& plot);
void add_decode(CLI::App& app);
void add_emulate(CLI::App& app);
void add_operator(CLI::App& app);
void add_doctor(CLI::App& app);
void add_repair_log(CLI::App& app);
void add_pictures(CLI::App& app);
void add_trial(CLI::App& app);
void add_watch(CLI::App& app);
void add_bus(CLI::App& app);
void add_vehicle(CLI::App& app);

}  // namespace fathom::tool
