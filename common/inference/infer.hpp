// From runs to a verdict: search, free force, both scores, and the causes as data.
#pragma once

#include <limits>

#include "common/inference/own_law.hpp"
#include "common/inference/search.hpp"

namespace fathom::inference {

struct Settings {
  std::vector<std::string> without{};              ///< effects that are not asked
  std::vector<const model::Effect*> candidates{};  ///< of measured columns, asked beside the listed ones
  int threads{2};
  double time_budget{
      std::numeric_limits<double>::infinity()};  ///< s by the clock on the wall: what is left is not asked
  Thresholds thresholds{};
  likelihood::RunSettings runs{};
};

/// A random force of one axis, as a number with a size.
struct RandomForce {
  int axis{};
  double sigma{};   ///< m/s^2 or rad/s^2
  double memory{};  ///< s
  double share{};   ///< of the applied acceleration
};

/// What no list holds and would move the vehicle as a named effect does with the numbers that were found.
struct LookAlike {
  std::string of;       ///< name of the effect
  std::string what;     ///< for people
  std::string told_by;  ///< the motion that would tell the two apart
};

struct Conclusion {
  Verdict verdict{Verdict::not_judged};
  std::vector<Reason> reasons;
  Found found;
  std::vector<Modulation> modulation;  ///< per effect of the best
  std::vector<RandomForce> random;
  std::vector<double> followed;  ///< per simulated axis: share of the acceleration that the model foretells
  /// Axes on which thrust acts and that runs which no fit has seen show to be foretold better than by saying that
  /// nothing changes and than by an equation of the axis alone: what the model lacks within a second, as of a thrust
  /// that comes late or a vehicle that shakes, is no reason to withhold its numbers there.
  std::vector<int> skilled;
  std::vector<LookAlike> look_alikes;
  /// Share by which numbers of the multi-horizon score surely lower the open-loop error of the fitted runs; 0: not.
  double disagreement{};
  /// Numbers for reports and exports, all of one fit, of the base model and of the best: those of the likelihood, which
  /// wastes nothing where the model is right, or of the multi-horizon score where these predict better by more than
  /// Thresholds::disagreement.
  likelihood::Fit reported_base, reported;
};

[[nodiscard]] Conclusion infer(const model::Vehicle& vehicle, std::span<const Trial> trials, const Settings& settings,
                               const Progress& progress);

/// The rules alone, for what was found.
void conclude(const likelihood::Problem& problem, const Thresholds& thresholds, Conclusion& conclusion);

}  // namespace fathom::inference
