// The diagnoser on line: the search of `fathom diagnose`, made beside the trial on what it has shown so far, each time
// that it has become twice as long. What is looked at, and from which message on the answer is told, follow from time
// stamps alone, so that a replay says the same, however quick the machine is.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/live/background_search.hpp"
#include "common/live/heard_trial.hpp"
#include "common/live/live_settings.hpp"
#include "common/model/site.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::live {

class LiveDiagnoser {
 public:
  /// Where an answer is not there when it is due: a log waits for it; a vehicle's messages do not, and rankings come
  /// late, each as it would have been.
  enum class Late { kIsWaitedFor, kIsToldLate };
  /// `go_on` is asked while something is waited for: false ends the waiting, and nothing is said any more.
  LiveDiagnoser(
      const LiveSettings& settings, const model::Vehicle& vehicle, std::optional<model::Site> site = {},
      Late late = Late::kIsWaitedFor, std::function<bool()> go_on = [] { return true; });
  LiveDiagnoser(const LiveDiagnoser&) = delete;  // its searches point into it
  LiveDiagnoser& operator=(const LiveDiagnoser&) = delete;

  /// Anything but STATE that a recording holds and `fathom diagnose` reads.
  template <class Sample>
  void hear(const Sample& sample) {
    trial_.hear(sample);
  }
  /// The trial's clock. A ranking follows every LiveSettings::interval: what the last search has found, "collecting"
  /// before.
  std::optional<EffectRanking> step(const StateEstimate& state);
  /// The streams have ended: what `fathom diagnose` says of all that was heard, a force that it learns included.
  std::optional<EffectRanking> finish();
  void reset();

  /// The first candidate of the last ranking and the one that it cannot be told from, with the numbers of both.
  [[nodiscard]] const Rivals& rivals() const { return told_.rivals; }
  /// What the end of the streams has shown that no list holds; nothing before it, or where the list explains all.
  [[nodiscard]] const std::optional<LearnedTold>& learned() const { return told_.learned; }
  /// What searches have told since they were last asked for, a line each.
  [[nodiscard]] std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }

 private:
  struct Look {
    double seconds{};  ///< of the trial that it saw
    Utime due{};       ///< time stamp from which on it is told
    BackgroundSearch search;
  };
  void look();
  [[nodiscard]] bool take_what_is_due(Utime utime);
  void tell(Found found, double seconds);
  /// `learn`: what the listed effects leave. A look has no time for it.
  [[nodiscard]] BackgroundSearch search(Utime end, BackgroundSearch::Priority priority, bool learn) const;

  LiveSettings settings_;
  std::unique_ptr<const model::Vehicle> vehicle_;
  std::unique_ptr<const model::Site> site_;  ///< null: none is known
  Late late_;
  std::function<bool()> go_on_;
  HeardTrial trial_;
  std::optional<Utime> first_;  ///< valid state
  Utime newest_{};              ///< likewise
  double next_look_;            ///< s of the trial
  std::int64_t said_{};         ///< rankings
  Found told_;
  std::vector<std::string> notes_;
  std::optional<Look> look_;  ///< begun and not told yet
};

}  // namespace fathom::live
