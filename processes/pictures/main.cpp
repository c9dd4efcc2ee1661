// fathom-pictures: what `fathom track` and its like run. Exit 0: done; 1: bad input, one line says what; 2: bad command
// line.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/base/error.hpp"
#include "processes/pictures/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Reads pictures: what `fathom` runs for its subcommands track and calibrate.", "fathom"};
  app.require_subcommand(1);
  fathom::pictures::add_track(app);
  fathom::pictures::add_calibrate(app);
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
