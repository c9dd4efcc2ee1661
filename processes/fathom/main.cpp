// fathom: the offline tool.
#include "common/runtime/command_line.hpp"
#include "common/runtime/large_blocks.hpp"
#include "processes/fathom/commands.hpp"

int main(int argc, char** argv) {
  fathom::runtime::give_back_large_blocks();  // a diagnosis of an hour at 100 Hz takes two thirds of the memory
  fathom::runtime::CommandLine app{"Explains from recordings why an underwater vehicle moves as it does.", "fathom"};
  fathom::tool::add_import(app);
  fathom::tool::add_check(app);
  fathom::tool::add_diagnose(app);
  fathom::tool::add_explain(app);
  fathom::tool::add_export(app);
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
  fathom::tool::add_spy(app);
  fathom::tool::add_trial(app);
  fathom::tool::add_vehicle(app);
  fathom::tool::add_examples(app);
  return app.run(argc, argv);
}
