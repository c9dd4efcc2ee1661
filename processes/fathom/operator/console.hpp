// An operator's ear and voice on a live bus: the newest of what matters, and orders.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/base/operator_key.hpp"
#include "common/excitation/preflight.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/self.hpp"
#include "common/runtime/speakers.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::tool {

class Console {
 public:
  using Clock = std::chrono::steady_clock;
  /// Whoever hears less is woken less: a bus in lockstep carries ten thousand messages a second.
  enum class Hears { kAll, kExcitation };
  /// Answers count where `keys` says that they are the vehicle's; without keys all do. InputError when the URL is no
  /// live bus.
  explicit Console(const std::string& url, Hears what = Hears::kAll, const std::optional<OperatorKeys>& keys = {});
  /// Hears for so long, or until `enough`. Ends early, too, when `wake` can be read.
  void listen(double seconds, const std::function<bool()>& enough = {}, int wake = -1);
  /// Signed where there are keys.
  void say(const Operator& order);
  /// The vehicle's time now, by its last word; nothing while none was heard.
  [[nodiscard]] std::optional<Utime> vehicle_time() const;
  /// s since EXCITATION was heard last, or since nobody has: it comes with every STATE.
  [[nodiscard]] double silence() const;
  /// Messages leave this host: somebody may be at the far end of a cable.
  [[nodiscard]] bool over_a_link() const;

  std::optional<Answer> gate;                    ///< newest of who moves the thrusters
  std::set<std::string> gates;                   ///< who says that he moves them, with his challenge
  bool foreign{false};                           ///< answers came that another key signed
  std::int64_t asked{};                          ///< the order whose answers are kept
  std::map<std::string, Answer> answers;         ///< to that order, by process
  std::function<void(const Answer&)> on_answer;  ///< each one that counts
  std::function<void(const Thrusters&)> on_thrusters;
  std::function<void(const VehicleCondition&)> on_vehicle;
  std::optional<Excitation> excitation;
  std::optional<StateEstimate> state;
  std::map<std::string, Health> health;
  std::optional<VehicleCondition> vehicle;
  /// What a preflight list is made of, with its age.
  [[nodiscard]] excitation::PreflightInput heard() const;

 private:
  void hear(const runtime::LiveInput::Message& message);
  void hear(Answer answer);

  runtime::Url url_;
  std::optional<OperatorKeys> keys_;
  std::vector<runtime::Subscription> heard_;
  runtime::LiveInput input_;
  runtime::Output output_;
  std::map<std::string, Clock::time_point> health_came_;
  runtime::Speakers speakers_{runtime::host_name(), runtime::Speakers::Home::kAnywhere};
  Clock::time_point gate_at_{}, state_came_{}, vehicle_came_{}, excitation_came_{Clock::now()};
};

}  // namespace fathom::tool
