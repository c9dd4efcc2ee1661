// What starts and stops programs on one or several hosts: procman's orders and answers as plain structs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom {

struct LaunchCommand {
  std::string id;                 ///< unique over all hosts
  std::string exec;               ///< program and arguments; no shell line
  std::string group;              ///< path such as "sensors/cameras"; empty for none
  bool auto_respawn{false};       ///< started again when it ends by itself
  std::int8_t stop_signal{2};     ///< sent first when it shall end
  float stop_time_allowed{7.0F};  ///< s until it is killed
  friend bool operator==(const LaunchCommand&, const LaunchCommand&) = default;
};

/// What a sheriff wants of one command.
struct CommandOrder {
  LaunchCommand command;
  std::int32_t run{};  ///< another number than the deputy's: start anew
  bool stop{false};    ///< shall not run
};

/// All that shall run on one host; what is not listed is stopped and forgotten.
struct LaunchOrders {
  Utime utime{};
  std::string deputy, sheriff;
  std::vector<CommandOrder> commands;
};

struct CommandStatus {
  LaunchCommand command;
  std::int32_t pid{};                                ///< 0: not running
  std::int32_t run{};                                ///< number of the order that started it
  std::int32_t wait_status{};                        ///< of the last end, as waitpid() gives it
  float cpu{};                                       ///< share of all cores
  std::int64_t virtual_memory{}, resident_memory{};  ///< [B]
};

struct DeputyInfo {
  Utime utime{};
  std::string deputy;
  float cpu_load{};                                                       ///< share of all cores
  std::int64_t memory_total{}, memory_free{}, swap_total{}, swap_free{};  ///< [B]
  std::vector<CommandStatus> commands;
};

/// Whoever starts asks all deputies to speak.
struct LaunchDiscovery {
  Utime utime{};
  std::string transmitter;  ///< a deputy's name, or a sheriff's
  std::int64_t nonce{};     ///< process number of a deputy, 0 of a sheriff
};

/// What commands have printed, or the deputy says about them.
struct LaunchOutput {
  struct Text {
    std::string id;  ///< of the command; empty: the deputy itself
    std::string text;
  };
  Utime utime{};
  std::string deputy;
  std::vector<Text> texts;
};

}  // namespace fathom
