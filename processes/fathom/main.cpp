// fathom: the offline tool. Exit 0: done; 1: bad input, one line says what; 2: bad command line.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/base/error.hpp"
#include "processes/fathom/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Explains from recordings why an underwater vehicle moves as it does.", "fathom"};
  app.set_version_flag("--version", FATHOM_VERSION);
  app.require_subcommand(1);
  fathom::tool::add_import(app);
  fathom::tool::add_check(app);
  fathom::tool::add_diagnose(app);
  fathom::tool::add_compare(app);
  fathom::tool::add_smooth(app);
  fathom::tool::add_regress(app);
  fathom::tool::add_methods(app);
  fathom::tool::add_plan(app);
  fathom::tool::add_decode(app);
  fathom::tool::add_emulate(app);
  fathom::tool::add_operator(app);
  fathom::tool::add_doctor(app);
  fathom::tool::add_repair_log(app);
  fathom::tool::add_pictures(app);
  fathom::tool::add_watch(app);
  fathom::tool::add_bus(app);
  fathom::tool::add_trial(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "fathom: %s; see fathom --help\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fathom: %s\n", error.what());
    return 1;
  }
}
