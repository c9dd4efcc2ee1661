// Models that were fitted, with what they are worth: the fits of a search and what follows from all of them together.
#pragma once

#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/progress.hpp"
#include "common/inference/scan.hpp"
#include "common/inference/verdict.hpp"

namespace fathom::inference {

/// A phase of the work as it is told.
struct Step {
  std::string_view phase, what;
  double weight{};  ///< guessed cost, in fits of one candidate
};
constexpr double kRoundsOfFit = 4.0;  ///< guessed, until some have ended
constexpr Step kCandidateFit{"candidates", "fitting what promises most", 1.0 / kRoundsOfFit};  ///< per round of a fit

/// A set of effects that was fitted.
struct Fitted {
  likelihood::Fit fit;
  std::vector<std::string> names;  ///< of its effects, sorted: what a posterior is about
  double score{};                  ///< log evidence and log prior of the set
};

/// Where a fit begins.
struct Start {
  likelihood::Hypothesis hypothesis;
  likelihood::Noise noise;
};

/// Log prior of a set: of their number, and uniform over sets and over the forms of each. What a craft that lives by
/// its flow has by nature is as likely as not, and not counted.
[[nodiscard]] double log_prior_of_set(const std::vector<model::ActiveEffect>& effects, const std::vector<Law>& laws);

/// A name in the best model, against all other sets of names that were fitted.
struct Standing {
  double probability{1.0};  ///< of all sets that hold it
  double odds{};            ///< nats of the best over the best set without it
  std::string rival;        ///< the likeliest other name in its place; empty: none
};

/// What a race is about, in scores.
struct Odds {
  double from{};                                             ///< of the model that all starts have in common
  double to_beat{-std::numeric_limits<double>::infinity()};  ///< of a model that is fitted already
  double near{10.0};  ///< nats by which what loses still tells something: odds between names
};

class FittedModels {
 public:
  /// `laws` must outlive it.
  FittedModels(const likelihood::Problem& problem, const std::vector<Law>& laws, int threads, const Progress& progress)
      : problem_{problem}, laws_{laws}, threads_{threads}, progress_{progress} {}

  Fitted add(likelihood::Fit fit);
  /// Each start, the most promising first, moved a little; it and those that came near enough to the best of them and
  /// to `to_beat`, seen from `from`, go on round by round, until what is still to be gained cannot bring them near it,
  /// or another has come to the same numbers. All are kept.
  std::vector<Fitted> race(const std::vector<Start>& starts, Odds of);
  /// All fitted to the end.
  std::vector<Fitted> fit_all(const std::vector<Start>& starts);
  /// For progress: so many starts are still to come.
  void expect(double starts) { tell(starts, 0.0); }

  [[nodiscard]] std::size_t size() const { return fitted_.size(); }
  /// `small`: sets of names of which one is too small to matter.
  [[nodiscard]] Standing standing(const Fitted& best, double base, const std::string& name,
                                  const std::set<std::vector<std::string>>& small) const;
  /// The best of exactly these names, sorted; nothing: none was fitted.
  [[nodiscard]] const Fitted* best_of(const std::vector<std::string>& names) const;
  /// The best of each other set of names whose score is at most `within` below the best's: `most` of them, best first.
  [[nodiscard]] std::vector<Fitted> near(const Fitted& best, double within, std::size_t most) const;
  /// The best that holds the name; nothing: none does.
  [[nodiscard]] const Fitted* best_with(const std::string& name) const;

 private:
  [[nodiscard]] Fitted judged(likelihood::Fit fit) const;
  /// A race or fit of so many starts begins.
  void begin(std::size_t starts);
  void tell(double starts, double rounds);
  /// Rounds that a fit has still to come after so many.
  [[nodiscard]] double rounds_after(double rounds) const;
  void ended(double fits, double rounds);

  const likelihood::Problem& problem_;
  const std::vector<Law>& laws_;
  int threads_;
  const Progress& progress_;
  std::vector<Fitted> fitted_;
  // For progress: starts that are still to come, and what those that have ended took.
  double to_come_{}, ended_{1.0}, rounds_{kRoundsOfFit};
};

}  // namespace fathom::inference
