// A search beside the trial, on a thread of its own.
#pragma once

#include <functional>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/progress.hpp"
#include "common/model/effect.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::live {

/// Two candidates, with their numbers, that the data cannot tell apart.
using Rivals = std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>>;

/// What a search came to.
struct Found {
  EffectRanking ranking;                 ///< without its time
  std::optional<LearnedTold> learned{};  ///< likewise; empty: none was asked for, or the listed effects are enough
  Rivals rivals;
  std::vector<std::string> notes;
};

class BackgroundSearch {
 public:
  using Work = std::function<Found(const Progress&)>;
  enum class Priority { kAsCaller, kBelow };

  /// `work` tells its Progress from the thread that it is called on; there it is ended, by an exception that it lets
  /// pass, when its answer is no longer wanted.
  BackgroundSearch(Work work, Priority priority);
  /// Ends the work and waits for that: until it tells of its progress once more.
  ~BackgroundSearch() = default;
  BackgroundSearch(BackgroundSearch&&) = default;
  BackgroundSearch& operator=(BackgroundSearch&&) = default;

  /// Its answer is no longer wanted.
  void abandon() { thread_.request_stop(); }
  [[nodiscard]] bool ready() const;
  /// The answer, waited for as long as `go_on` says so; nothing: it says no more. Throws what the work has thrown.
  /// Once.
  [[nodiscard]] std::optional<Found> wait(const std::function<bool()>& go_on);

 private:
  std::future<Found> found_;
  std::jthread thread_;
};

}  // namespace fathom::live
