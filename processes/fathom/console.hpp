// An operator's ear and voice on a live bus: the newest of what matters, and orders.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/excitation/preflight.hpp"
#include "common/runtime/bus.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"

namespace fathom::tool {

class Console {
 public:
  /// Whoever hears less is woken less: a bus in lockstep carries ten thousand messages a second.
  enum class Hears { kAll, kExcitation };
  /// InputError when the URL is no live bus.
  explicit Console(const std::string& url, Hears what = Hears::kAll);
  /// Hears for so long, or until `enough`.
  void listen(double seconds, const std::function<bool()>& enough = {});
  void say(const Operator& order);

  std::optional<Utime> vehicle_time;  ///< of the thrusters: the clock that judges orders
  std::optional<Excitation> excitation;
  std::optional<StateEstimate> state;
  std::map<std::string, Health> health;
  std::optional<VehicleCondition> vehicle;
  /// What a preflight list is made of, with its age.
  [[nodiscard]] excitation::PreflightInput heard() const;

 private:
  using Clock = std::chrono::steady_clock;
  void hear(const runtime::LiveInput::Message& message);

  runtime::Url url_;
  std::vector<runtime::Subscription> heard_;
  runtime::LiveInput input_;
  runtime::Output output_;
  std::map<std::string, Clock::time_point> health_came_;
  Clock::time_point state_came_{}, vehicle_came_{};
};

}  // namespace fathom::tool
