// A sheriff at work: hears deputies and HEALTH, gives orders each second, shows what becomes of them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/launch/script_run.hpp"
#include "common/launch/sheriff.hpp"
#include "common/launch/table.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/self.hpp"
#include "common/runtime/speakers.hpp"
#include "common/runtime/stop_signal.hpp"
#include "processes/sheriff/local_deputies.hpp"
#include "processes/sheriff/screen.hpp"

namespace fathom::sheriff {

struct Options {
  std::string config;
  std::string script;
  std::string url;         ///< of procman's channels
  std::string health_url;  ///< of the programs' HEALTH
  std::string logs;        ///< folder for what the programs print; empty: none
  bool status{false}, stop{false}, stay{false}, local{false}, verbose{false};
};

class Office {
 public:
  Office(Options options, launch::LaunchConfig config);
  /// Exit status: 0 when all is as it shall be at the end, 1 when not, 130 when interrupted.
  int run();

 private:
  void hear();
  /// One round: waits a little, hears, orders, shows.
  void round();
  void rounds(double seconds);
  [[nodiscard]] bool everybody_heard() const;
  void call();
  void gather();
  void keep(const std::string& command, const std::string& text);
  bool play(const launch::Script& script, launch::ScriptRun::Care care);
  bool stop_all();
  int judge(bool well);

  Options options_;
  runtime::StopSignal interrupt_;  // before liblcm starts its thread
  launch::Sheriff mind_;
  launch::HealthBoard health_;
  runtime::Speakers speakers_{runtime::host_name(), runtime::Speakers::Home::kAnywhere};
  runtime::LiveInput procman_, health_input_;
  runtime::Output output_;
  Screen screen_;
  LocalDeputies local_;
  double next_order_{}, next_call_{};
  std::string doing_;
  std::map<std::string, std::string> printed_;  ///< last words of each command
  std::string rival_told_;
  std::map<std::string, std::string> allowed_;  ///< of each deputy, as it says
};

}  // namespace fathom::sheriff
