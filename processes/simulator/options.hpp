// The simulator's own part of the command line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/operator_key.hpp"
#include "common/samples/commands.hpp"
#include "common/simulation/simulator.hpp"

namespace fathom::runtime {
class CommandLine;
}

namespace fathom::simulator {

struct Options {
  simulation::Setup setup;
  double speed{1.0};                  ///< of virtual time over the wall's; 0: as fast as the followers answer
  bool until_done{false};             ///< the run ends when the supervisor's trial does
  std::vector<std::string> wait_for;  ///< lockstep with these processes; empty: none is waited for
  std::vector<std::string> orders;    ///< "TIME=WORD"
  std::string out_dir;                ///< of truth.json; empty: not written
  std::string camera_at;  ///< "tcp:PORT": the camera sends its pictures there, to camera_driver; empty: on CAMERA
  std::string drivers;    ///< file of the drivers that are fed with bytes; empty: their channels are spoken on
  std::string manoeuvre;  ///< preset that is flown here, whatever is commanded; empty: commands are obeyed
  OperatorKeys keys{};    ///< with which its own orders are signed and those of others believed

  void add_to(runtime::CommandLine& app);
  /// The operator's orders in the order of their times (their utime), not numbered yet. InputError for a bad one.
  [[nodiscard]] std::vector<Operator> schedule() const;
  /// InputError for words that do not go together.
  void check() const;
};

}  // namespace fathom::simulator
