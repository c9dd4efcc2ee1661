// The deputy's mind: from orders, deaths, health and time to what shall be started, signalled and said. It owns no
// process and reads no clock; whoever does asks take_acts() after every call and carries them out.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/launch/allow_list.hpp"
#include "common/launch/backoff.hpp"
#include "common/samples/launch.hpp"

namespace fathom::launch {

struct Act {
  enum class Kind {
    kStart,   ///< the command line that is in `exec`
    kSignal,  ///< `signal` to the program and all its descendants
    kSay      ///< `text`, about the command
  };
  Kind kind{};
  std::string id;
  std::string exec{};
  int signal{};
  std::string text{};
};

class Deputy {
 public:
  static constexpr double kStale = 60.0;   ///< s that an order may be old, or ahead of this host's clock
  static constexpr double kSilence = 4.0;  ///< s without HEALTH, and without computing: it hangs
  static constexpr double kBusy = 60.0;    ///< s without HEALTH while it computes: it hangs as well

  /// `allowed`: what may be run; without it whatever is ordered.
  explicit Deputy(std::string name, std::optional<AllowList> allowed = {})
      : name_{std::move(name)}, allowed_{std::move(allowed)} {}

  [[nodiscard]] const std::optional<AllowList>& allowed() const { return allowed_; }
  /// `wall` is the clock of the orders, `now` a clock that only goes forward [s].
  void hear(const LaunchOrders& orders, Utime wall, double now);
  void started(const std::string& id, std::int32_t pid, double now);
  void died(const std::string& id, std::int32_t wait_status, double now);
  /// HEALTH of the program with this number.
  void healthy(std::int32_t pid, double now);
  /// What a running program uses; `computes`: it has used processor time since the last call.
  struct Use {
    float cpu{};
    std::int64_t virtual_memory{}, resident_memory{};
    bool computes{};
  };
  void uses(const std::string& id, const Use& use, double now);
  /// Time has passed: respawns, kills, silence.
  void tick(double now);
  /// Stops everything; further orders are not heard.
  void shut_down(double now);

  [[nodiscard]] std::vector<Act> take_acts();
  /// True once after every change that sheriffs should hear of at once.
  [[nodiscard]] bool take_changed();
  /// Shut down, and nothing runs any more.
  [[nodiscard]] bool over() const;
  /// Name and commands; the host's figures are for others to fill in.
  [[nodiscard]] DeputyInfo info(Utime wall) const;
  /// Seconds until tick() has something to do; at most a second.
  [[nodiscard]] double idle(double now) const;

 private:
  struct Entry {
    CommandStatus status{};
    bool wanted{false};
    bool starting{false};  ///< ordered from take_acts(), not yet started()
    bool forget{false};
    std::optional<double> signalled{};  ///< first stop signal
    std::optional<double> killed{};     ///< last SIGKILL
    std::optional<double> respawn{};    ///< when
    std::optional<double> health{};     ///< last HEALTH since the start
    double computed{};                  ///< when it was last seen to use the processor
    bool hangs{false};
    Backoff backoff{};
    [[nodiscard]] bool runs() const { return status.pid > 0 || starting; }
  };
  void obey(Entry& entry, const CommandOrder& order, double now);
  [[nodiscard]] bool permits(const LaunchCommand& command) const { return !allowed_ || allowed_->permits(command); }
  void start(Entry& entry, double now);
  void stop(Entry& entry, double now);
  void kill(Entry& entry, double now);
  void watch(Entry& entry, double now);
  void say(const Entry& entry, std::string text);

  std::string name_;
  std::optional<AllowList> allowed_;
  std::map<std::string, Entry> entries_;
  std::vector<std::string> order_;  ///< ids as they came, for info()
  std::vector<Act> acts_;
  bool changed_{false};
  bool closing_{false};
};

}  // namespace fathom::launch
