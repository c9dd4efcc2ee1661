// "Could you be this?", asked of every form of every effect: a quick look on a spread of windows, a careful one at
// those that promise something, and full fits from afar for effects that only show when they are large.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/diagnosis/judgement.hpp"

namespace fathom::diagnosis {

struct Candidate {
  const model::Effect* effect{};
  int variant{};
  std::string name{};
};

/// Every form of every registered effect that can act and be seen in this scene.
[[nodiscard]] std::vector<Candidate> all_candidates(const model::Scene& scene);

/// Answers in the order of the candidates.
struct Answers {
  std::vector<Screened> screened;
  std::vector<Judged> judged;  ///< by the screening until a fit has told, refusals included
  std::vector<bool> fitted;    ///< in full
};

/// Those of `candidates` that `fit` does not hold are asked.
[[nodiscard]] Answers ask(std::span<const Candidate> candidates, const identification::TrajectoryFit& problem,
                          const identification::FitResult& fit, const model::Scene& scene, const Settings& settings);

/// Full fits on a spread of windows for effects whose small sizes tell nothing about their large ones. What is found
/// waits for another full fit. `progress` hears of it at `share`.
void look_afar(Answers& answers, const identification::TrajectoryFit& problem, const identification::FitResult& fit,
               std::span<const Trial> train, const model::Scene& scene, const Settings& settings,
               const Progress& progress, double share);

/// The best form of each effect that may matter, those that gain most first.
[[nodiscard]] std::vector<std::size_t> worth_fitting(const Answers& answers, const Settings& settings);

/// Where the full fit of an answer begins.
[[nodiscard]] model::Model start_of(const identification::FitResult& fit, const Screened& screened);

}  // namespace fathom::diagnosis
