// What every process says about itself: HEALTH, PROCESS_INFO.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom {

/// One channel that a process listens to.
struct ChannelHealth {
  std::string channel;
  double rate{};  ///< 1/s, in the last second
  double age{};   ///< s since the newest message came; since the start while none has come
};

/// Once a second on a live bus; counts are since the start.
struct Health {
  Utime utime{};  ///< wall clock
  std::string process;
  std::string host;
  std::int32_t pid{};       ///< on that host: two processes of one name are told apart
  std::int64_t start{};     ///< us since the host's boot: when it began, as the kernel says
  std::int64_t sequence{};  ///< number of this word, from 1
  std::string state;        ///< "running", "unhealthy" (detail begins with the reason), "stopped", "fault"
  std::int64_t received{};  ///< delivered to handlers
  std::int64_t published{};
  std::int64_t dropped{};   ///< lost to a full queue
  std::int64_t rejected{};  ///< undecodable or not plausible
  double busy{};            ///< share of the last second spent in handlers, 0..1
  double cpu{};             ///< share of one core in the last second
  std::int64_t memory{};    ///< resident [B]
  std::string detail;       ///< counts per channel; the reason of a fault
  std::vector<ChannelHealth> channels{};
};

/// Said once at the start, so that a log explains itself.
struct ProcessInfo {
  Utime utime{};
  std::string process;
  std::string version;
  std::string config;    ///< text of all configuration files
  std::string channels;  ///< one "hears|says CHANNEL TYPE" per line
};

}  // namespace fathom
