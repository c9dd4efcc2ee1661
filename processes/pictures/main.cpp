// fathom-pictures: what `fathom track` and its like run.
#include "common/runtime/command_line.hpp"
#include "processes/pictures/commands.hpp"

int main(int argc, char** argv) {
  fathom::runtime::CommandLine app{"Reads pictures: what `fathom` runs for its subcommands track and calibrate.", "fathom"};
  fathom::pictures::add_track(app);
  fathom::pictures::add_calibrate(app);
  return app.run(argc, argv);
}
