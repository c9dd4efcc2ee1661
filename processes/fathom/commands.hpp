// The subcommands of the offline tool. Each adds itself to the command line; what it does runs after parsing.
#pragma once

namespace CLI {
class App;
}

namespace fathom::tool {

void add_import(CLI::App& app);
void add_check(CLI::App& app);
void add_diagnose(CLI::App& app);
void add_compare(CLI::App& app);
void add_decode(CLI::App& app);
void add_emulate(CLI::App& app);
void add_operator(CLI::App& app);

}  // namespace fathom::tool
