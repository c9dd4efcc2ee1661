// What has happened, one line each: phases, orders, processes that fall silent and come back, verdicts.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/board/roll.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::board {

/// Pure: times are passed in, in seconds of any steady clock. Only changes are noted.
class Chronicle {
 public:
  static constexpr std::size_t kMost = 200;  ///< lines; older ones are in the log
  struct Line {
    double at{};
    std::string kind;  ///< "good", "bad", "warn", "go" or ""
    std::string text;
  };

  void hear(const Excitation& said, double now);
  void hear(const EffectRanking& said, double now);
  void hear(const LearnedTold& said, double now);
  void hear(const ModelEstimate& said, double now);
  void hear(const VehicleCondition& said, double now);
  /// What became of an order; what is told without one is left out.
  void hear(const Answer& said, double now);
  /// Who is there and how, as often as one likes.
  void look(std::span<const Roll::Entry> processes, double now);
  void note(double now, const std::string& kind, const std::string& text);

  [[nodiscard]] const std::deque<Line>& lines() const { return lines_; }  ///< oldest first

 private:
  std::deque<Line> lines_;
  std::optional<std::string> phase_, verdict_, adopted_, condition_;
  std::string answered_;
  std::map<std::string, std::string> states_;  ///< of processes, by name and host
};

}  // namespace fathom::board
