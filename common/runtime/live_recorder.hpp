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
  /// "unhealthy" where there is a trouble, which is told at once; `lost`: messages that were heard and not written.
  void tell(const std::string& trouble, const std::string& text, std::int64_t lost = 0);
  /// Its last word: "stopped", or "fault" with the reason.
  void end(const std::string& state, const std::string& reason);

 private:
  void say_health(const std::string& state, const std::string& detail);

  Output& bus_;
  Usage usage_;
  std::int64_t received_{}, lost_{}, words_{};
  bool well_{true};
  std::chrono::steady_clock::time_point last_{};
};

/// Until SIGINT or SIGTERM. `number`: ".00" or the next number is added to the path, and where a disk is full the
/// recorder stays, says so, and goes on with the next number when there is room. `without`: channels that are not
/// recorded. Events that are whole stay; a file without any is removed. InputError when nothing can be written, and
/// with one path when writing fails.
void record_live(const std::vector<Url>& in, const Url& out, const std::string& path, bool number,
                 const std::vector<std::string>& without);

}  // namespace fathom::runtime
