// The outcome of a live trial as its log tells it; and, apart from it, the comparison with a simulator's truth.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/entanglement.hpp"
#include "common/samples/estimates.hpp"

namespace fathom {

/// One visit of a mode of the schedule.
struct ModeVisit {
  std::string mode;  ///< "yaw", ..., "total"
  double begun{};    ///< s after the log's first message
  double ended{};
  bool left{false};  ///< all tests agreed that it may be left; else given up, skipped or cut short
  double metric{-1.0};
  double threshold{};
  std::string missing;  ///< what was missing at the end
};

/// A segment that was flown by its name.
struct FlownSegment {
  std::string segment;
  double begun{};  ///< s after the log's first message
  double ended{};
};

/// What the true values say, when a simulator has written them down. Nothing else is computed from them.
struct TruthComparison {
  std::map<std::string, double> parameters;
  std::vector<std::string> effects;  ///< hidden ones, with their numbers, for people
  std::vector<std::string> effect_names;
  std::array<int, 3> contacts{};             ///< walls, floor, surface
  std::array<double, 6> state_rms{};         ///< m and m/s: error of position in W, of u v w
  std::array<double, 6> state_worst{};       ///< largest
  std::array<double, 6> state_normalised{};  ///< mean square of error over stated std: 1 when that is right
  std::size_t compared{};                    ///< states
};

/// What a diagnosis of the trial's own log found.
struct Afterwards {
  std::string page;     ///< its report, from where the trial's page lies; empty: none
  std::string verdict;  ///< "adequate", "effect", "ambiguous", "unexplained" or "unjudged"
  std::vector<EffectEvidence> effects;
  std::map<std::string, double> before, after;  ///< RMS of 5 s predictions by velocity, m/s or rad/s
  std::optional<double> improvement;            ///< share of the prediction error that is gone
};

struct LiveTrialResult {
  std::string vehicle;
  std::string site;
  double seconds{};    ///< of the log
  std::string phase;   ///< the supervisor's last: "done", "aborted", "lost", ...
  std::string reason;  ///< its last words
  std::vector<FlownSegment> flights;
  std::vector<ModeVisit> visits;
  std::vector<NamedValue> parameters;      ///< identified, the std honest
  bool joint{false};                       ///< of the joint estimate; else of the recursive one
  std::optional<double> joint_from;        ///< s, when the joint estimate spoke first
  std::vector<std::string> failing;        ///< axes whose residual has failed its test: the model lacks something
  Entanglement entangled;                  ///< theirs, at the end
  std::vector<NamedValue> expected;        ///< of the vehicle file: what was known before, for reference
  std::vector<std::string> adopted;        ///< effects in the identifier's model
  std::vector<NamedValue> effect_numbers;  ///< theirs, "effect.parameter"
  EffectRanking ranking;                   ///< the diagnoser's last
  std::optional<LearnedTold> learned{};    ///< at the end
  std::map<std::string, std::string> complaints;  ///< by process: what it called unhealthy
  std::optional<Afterwards> afterwards;
  std::optional<TruthComparison> truth;
  /// Every mode was left by its own tests.
  [[nodiscard]] bool settled() const {
    for (const ModeVisit& visit : visits) {
      if (!visit.left) return false;
    }
    return phase == "done" && !visits.empty();
  }
};

}  // namespace fathom
