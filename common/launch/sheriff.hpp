// The sheriff's mind: what shall run, against what the deputies say runs. It sends nothing and reads no clock.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/launch/config.hpp"
#include "common/samples/launch.hpp"

namespace fathom::launch {

enum class State {
  kUnheard,     ///< its deputy has never spoken
  kLost,        ///< its deputy has fallen silent
  kStarting,    ///< ordered
  kRestarting,  ///< ordered
  kRunning,
  kStopping,  ///< ordered
  kIdle,      ///< never started
  kStopped,   ///< well
  kFailed,    ///< ended by itself, badly
  kUnknown
};
[[nodiscard]] const char* word(State state);

class Sheriff {
 public:
  static constexpr double kLost = 5.0;     ///< s without a deputy's word
  static constexpr double kRecent = 10.0;  ///< s in which two failures mean that it keeps failing
  static constexpr double kStale = 30.0;   ///< s that a deputy's word may be old

  Sheriff(std::string id, LaunchConfig config);

  /// Adopts what already runs: an order lists everything, so what it leaves out would be stopped.
  void hear(const DeputyInfo& info, Utime wall, double now);
  /// Orders of another sheriff.
  void hear(const LaunchOrders& orders, double now);

  void start(const Target& target);
  void stop(const Target& target);
  void restart(const Target& target);

  /// To every deputy that has spoken. Nothing before something was ordered: looking on changes nothing.
  [[nodiscard]] std::vector<LaunchOrders> orders(Utime wall) const;
  /// True once after every order that the deputies should hear at once.
  [[nodiscard]] bool take_changed();

  struct Row {
    LaunchCommand command;
    std::string deputy;
    State state{};
    CommandStatus status;
    bool started{false};      ///< by us, or it was seen running
    bool wanted{false};       ///< shall run
    bool differs{false};      ///< runs with another command line than the configuration's
    bool foreign{false};      ///< not in the configuration
    int failures{};           ///< by itself, within kRecent
    std::int32_t last_end{};  ///< wait status of the last of them
  };
  [[nodiscard]] std::vector<Row> rows(double now) const;
  [[nodiscard]] std::vector<Row> rows(const Target& target, double now) const;

  /// Of those that the configuration names.
  [[nodiscard]] std::vector<std::string> unheard_deputies(double now) const;
  /// "SHERIFF" when another one gives orders too.
  [[nodiscard]] std::string rival(double now) const;
  /// One line per command that is not as it should be. An onlooker complains of old failures too.
  [[nodiscard]] std::vector<std::string> complaints(double now, bool onlooker = false) const;
  [[nodiscard]] const LaunchConfig& config() const { return config_; }

 private:
  struct Entry {
    LaunchCommand command;
    std::string deputy;
    bool foreign{false};
    bool adopted{false};       ///< its deputy has told of it
    std::string running_exec;  ///< command line that it was running with when adopted
    std::int32_t desired{};
    bool stop{false};
    bool started{false};    ///< by us, or running when adopted
    bool by_itself{false};  ///< has ended before anybody asked it to
    std::optional<CommandStatus> status{};
    std::int32_t last_pid{};
    std::vector<double> failures{};  ///< when
    std::int32_t last_end{};
  };
  void adopt(Entry& entry, const CommandStatus& status, double now);
  static void count_failures(Entry& entry, const CommandStatus& status, double now);
  [[nodiscard]] State state(const Entry& entry, double now) const;

  std::string id_;
  LaunchConfig config_;
  std::vector<Entry> entries_;
  std::map<std::string, double> heard_;  ///< deputies, when last
  std::string rival_;
  double rival_heard_{};
  bool ordered_{false};
  bool changed_{false};
};

}  // namespace fathom::launch
