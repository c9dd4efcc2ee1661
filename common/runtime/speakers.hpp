// Whose HEALTH is believed. Anybody on the bus can say HEALTH in the name of a process, and so hide that it is dead. A
// process's own words are numbered, and carry what its kernel knows it by (number and moment of its start): of this
// host's processes the kernel is asked whether there is such a one.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace fathom_lcm {
class health_t;
}

namespace fathom::runtime {

/// When the process began [us since the host's boot], of a process of this host. Nothing when there is none of this
/// number; 0 where the kernel does not show others' processes.
[[nodiscard]] std::optional<std::int64_t> process_start(std::int32_t pid);

class Speakers {
 public:
  enum class Home {
    kAnywhere,  ///< processes of one name may run on several hosts
    kFirst      ///< a name that a process of this host has had is no other host's
  };
  static constexpr char kNotBelieved[] =
      "HEALTH of a process that does not run on this host, or said before, is not believed: somebody plays a log, has "
      "this host's name, or lies";
  /// `host`: this one; empty: none can be asked, as when a log is read.
  Speakers(std::string host, Home home) : host_{std::move(host)}, home_{home} {}

  /// Not what repeats an earlier word; no process of this host that there is not (its last word, "stopped" or "fault",
  /// outlives it).
  [[nodiscard]] bool believes(const fathom_lcm::health_t& health);

 private:
  static constexpr std::size_t kMost = 500;  ///< of identities that a hostile publisher may make up
  using Identity = std::tuple<std::string, std::string, std::int32_t, std::int64_t>;  ///< name, host, number, start
  struct Last {
    std::int64_t sequence{};
    std::uint64_t heard{};  ///< how many words ago, for the oldest to be forgotten
  };
  [[nodiscard]] bool lives(const fathom_lcm::health_t& health) const;

  std::string host_;
  Home home_;
  std::set<std::string> own_;  ///< names that this host's processes have had
  std::map<Identity, Last> last_;
  std::uint64_t words_{};
};

}  // namespace fathom::runtime
