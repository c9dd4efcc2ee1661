// Records a bus in real time: every message as it comes, with the kernel's time. lcm-logger does so too, but loses what
// comes while it is kept from the processor for a tenth of a second: liblcm keeps thirty messages for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/runtime/bus.hpp"
#include "common/runtime/self.hpp"

namespace fathom::runtime {

/// A recorder's HEALTH, once a second.
class RecorderHealth {
 public:
  explicit RecorderHealth(Output& bus);
  void heard() { ++received_; }
  void tell(std::int64_t written);
  /// Its last word: "stopped", or "fault" with the reason.
  void end(const std::string& state, const std::string& reason);

 private:
  void say_health(const std::string& state, const std::string& detail);

  Output& bus_;
  Usage usage_;
  std::int64_t received_{};
  std::chrono::steady_clock::time_point last_{};
};

/// Until SIGINT or SIGTERM. `number`: ".00" or the first number that is free is added to the path. `without`: channels
/// that are not recorded.
void record_live(const std::vector<Url>& in, const Url& out, const std::string& path, bool number,
                 const std::vector<std::string>& without);

}  // namespace fathom::runtime
