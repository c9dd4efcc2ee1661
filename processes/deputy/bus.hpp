// A deputy's two ears and one mouth: procman's channels, and the HEALTH of the programs, which may be on another bus.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "common/runtime/bus.hpp"
#include "common/runtime/speakers.hpp"
#include "common/samples/health.hpp"
#include "common/samples/launch.hpp"

namespace fathom::deputy {

class Bus {
 public:
  struct Handlers {
    std::function<void(const LaunchOrders&)> orders;
    std::function<void(const DeputyInfo&)> info;
    std::function<void(const LaunchDiscovery&)> discovery;
    std::function<void(const Health&)> health;
  };
  Bus(const std::string& url, const std::string& health_url, Handlers handlers);

  [[nodiscard]] std::vector<int> descriptors() const;
  [[nodiscard]] bool pending() const { return procman_.pending() || health_.pending(); }
  /// Hands over what has come. What cannot be decoded is counted.
  void serve();
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

  void say(const DeputyInfo& info);
  void say(const LaunchDiscovery& discovery);
  void say(const LaunchOutput& output);

 private:
  template <class Message, class Handler>
  void hand(const runtime::LiveInput::Message& message, const Handler& handler);

  Handlers handlers_;
  runtime::LiveInput procman_;
  runtime::LiveInput health_;
  runtime::Output output_;
  runtime::Speakers speakers_;
  std::uint64_t rejected_{};
};

}  // namespace fathom::deputy
