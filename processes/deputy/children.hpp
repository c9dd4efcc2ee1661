// The programs that this deputy has started, each on a terminal of its own (on a pipe where there is none).
#pragma once

#include <poll.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/launch/exec_line.hpp"

namespace fathom::deputy {

class Children {
 public:
  /// What a program has printed, as its terminal gives it.
  using Print = std::function<void(const std::string& id, std::string_view text)>;
  using Death = std::function<void(const std::string& id, std::int32_t wait_status)>;

  Children(Print print, Death death) : print_{std::move(print)}, death_{std::move(death)} {}
  ~Children();
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;

  /// Process number; 0 when it cannot be run, which is then printed.
  [[nodiscard]] std::int32_t start(const std::string& id, const std::string& exec);
  /// To the program and all that came of it.
  void signal(const std::string& id, int number);
  [[nodiscard]] std::int32_t pid(const std::string& id) const;

  void watch(std::vector<pollfd>& into) const;
  /// Reads what they printed; to be called when a watched descriptor is readable.
  void read();
  /// Takes in those that have ended.
  void reap();

 private:
  struct Child {
    std::int32_t pid{};
    int terminal{-1};
    bool silent{false};  ///< it has closed its side
    bool signalled{false};
  };
  void drain(const std::string& id, Child& child);

  Print print_;
  Death death_;
  std::map<std::string, Child> children_;
};

}  // namespace fathom::deputy
