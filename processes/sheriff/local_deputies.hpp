// Deputies that the sheriff itself starts on this host, for a trial on one machine.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace fathom::sheriff {

class LocalDeputies {
 public:
  LocalDeputies() = default;
  ~LocalDeputies() { stop(); }
  LocalDeputies(const LocalDeputies&) = delete;
  LocalDeputies& operator=(const LocalDeputies&) = delete;

  /// The program `deputy` of the sheriff's own folder; it runs the command lines of this configuration alone.
  /// InputError when it cannot be run.
  void start(const std::string& name, const std::string& url, const std::string& config);
  /// Asks them to go, and waits until they and all their programs have gone.
  void stop();
  [[nodiscard]] bool any() const { return !pids_.empty(); }

 private:
  std::vector<pid_t> pids_;
};

}  // namespace fathom::sheriff
