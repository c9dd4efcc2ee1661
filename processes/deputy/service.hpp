// A deputy at work: looks for another of its name, then obeys orders until it is told to go.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/launch/deputy.hpp"
#include "common/launch/output_limit.hpp"
#include "processes/deputy/bus.hpp"
#include "processes/deputy/children.hpp"
#include "processes/deputy/host.hpp"
#include "processes/deputy/signals.hpp"
#include "processes/deputy/systemd.hpp"

namespace fathom::deputy {

struct Options {
  std::string name;
  std::string url;                   ///< of procman's channels
  std::vector<std::string> allow{};  ///< configurations whose command lines alone may be run; none: any
  bool verbose{false};               ///< what programs print goes to stderr too
};

class Service {
 public:
  static constexpr double kLook = 0.6;  ///< s that it listens for another of its name
  static constexpr double kCall = 0.2;  ///< s between two calls meanwhile

  explicit Service(Options options);
  /// Exit status as procman's: 0 told to go; 1 another one of this name is starting; 2 another one is there.
  int run();

 private:
  void hear(const DeputyInfo& info);
  void hear(const LaunchDiscovery& discovery);
  void act();
  void measure(double now);
  void tell();
  void tell_allowed();
  void flush(double now);
  void print(const std::string& id, std::string_view text);
  void wait(double seconds);
  int leave();

  Options options_;
  Signals signals_;  // before liblcm starts its thread
  Systemd systemd_;
  launch::Deputy mind_;
  launch::OutputLimit output_;
  Children children_;
  Bus bus_;
  bool looking_{true};
  int status_{-1};           ///< of an early exit
  std::vector<Utime> told_;  ///< times of our own last infos: others of our name are another's
  double rival_told_{-1e9};
  Jiffies jiffies_{};
  float load_{};
  std::map<std::string, std::int64_t> used_;  ///< jiffies of each program
  bool tell_now_{false}, asked_{false};
};

}  // namespace fathom::deputy
