// A simulated recording with a base model fitted to it and whatever no list holds sought beside it.
#pragma once

#include <cstdio>
#include <cstdlib>

#include "common/learning/learn.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

namespace fathom::test {

inline const model::Vehicle& bluerov() {
  static const model::Vehicle vehicle = vehicle_from_repository("bluerov2");
  return vehicle;
}

/// Samples [from, to) of a trial.
inline Trial part_of(const Trial& whole, std::size_t from, std::size_t to) {
  Trial part = whole;
  const auto cut = [&](auto& series) {
    if (series.size() != whole.size()) return;
    using Series = std::remove_reference_t<decltype(series)>;
    series =
        Series(series.begin() + static_cast<std::ptrdiff_t>(from), series.begin() + static_cast<std::ptrdiff_t>(to));
  };
  cut(part.p_WB), cut(part.q_WB), cut(part.nu), cut(part.pose_valid), cut(part.velocity_valid), cut(part.rates_valid);
  cut(part.input), cut(part.input_valid), cut(part.held), cut(part.told), cut(part.voltage), cut(part.t);
  return part;
}

/// A recording with a base model fitted to it and whatever no list holds sought beside it.
struct LearnedCase {
  /// `fitted`: share of the dive that is fitted, its beginning.
  explicit LearnedCase(const NoisyDive& settings, bool seek = true, double fitted = 1.0)
      : dive{fly(bluerov(), settings)},
        trial{part_of(dive.trial, 0, static_cast<std::size_t>(fitted * static_cast<double>(dive.trial.size())))},
        rest{part_of(dive.trial, trial.size(), dive.trial.size())},
        problem{likelihood::make_problem(bluerov(), {&trial, 1})} {
    conclusion.verdict = inference::Verdict::unexplained;
    conclusion.found.base.fit = conclusion.found.best.fit =
        likelihood::fit(problem, likelihood::nominal_hypothesis(problem), likelihood::prior_noise(problem),
                        {.noise_rounds = 3, .threads = 2});
    if (!seek) return;
    conclusion.found.free_force = inference::find_free_force(
        problem, inference::see(problem, conclusion.found.best.fit, 2), model::scene_of(bluerov(), {&trial, 1}), {}, 2);
  }
  [[nodiscard]] learning::Learned learned(bool judged_here = true) const {
    return learning::learn(problem, {&trial, 1}, conclusion, {}, judged_here, 2, {});
  }

  VirtualDive dive;
  Trial trial, rest;
  likelihood::Problem problem;
  inference::Conclusion conclusion;
};

/// Where FATHOM_SHOW is set.
inline void show(const char* what, const CorrectionGiven& given) {
  if (std::getenv("FATHOM_SHOW") == nullptr) return;
  std::printf(
      "%s: adopted %d carried %d odds %.1f size %.4f held out %.4f carried %.4f windows %d cut %d\n  %s\n  %s\n", what,
      given.adopted, given.carried, given.log_odds, given.size, given.held_out, given.held_out_carried, given.windows,
      given.shortened, given.refused.c_str(), given.words.c_str());
}

}  // namespace fathom::test
