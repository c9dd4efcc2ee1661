// "Could you be this?", asked of every form of every effect: a quick look on a spread of windows, a careful one at
// those that promise something, and full fits from afar for effects that only show when they are large.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/judgement.hpp"

namespace fathom::diagnosis {

/// Of the smallest reduction: less on a spread of windows promises nothing.
inline constexpr double kPromise = 0.5;

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

/// The same problem on a spread of windows, made when it is first asked for: enough to tell whether a full fit leads
/// anywhere. What it is made from must outlive it.
class Coarse {
 public:
  Coarse(const identification::TrajectoryFit& whole, std::span<const Trial> train, const Settings& settings,
         const identification::FitResult& fit);
  /// False when all windows are hardly more.
  [[nodiscard]] bool useful() const;
  [[nodiscard]] const identification::TrajectoryFit& problem();
  /// The fit without a candidate.
  [[nodiscard]] const identification::FitResult& reference();

 private:
  const identification::TrajectoryFit& whole_;
  std::span<const Trial> train_;
  const Settings& settings_;
  const identification::FitResult& fit_;
  std::optional<identification::TrajectoryFit> problem_;
  identification::FitResult like_, reference_;
};

/// Coarse fits for effects whose small sizes tell nothing about their large ones. What is found waits for another full
/// fit. `progress` hears of it at `share`.
void look_afar(Answers& answers, Coarse& coarse, const identification::FitResult& fit, const model::Scene& scene,
               const Progress& progress, double share);

/// How much of what the screening promised a full fit has kept, effect by effect. For some effects the linear picture
/// flatters: large masses and onsets imitate what the base model can do by itself.
class Promises {
 public:
  /// Gain that a full fit may bring.
  [[nodiscard]] double expected(const Screened& screened) const;
  /// Notes what a full fit has brought.
  void kept(const Screened& screened, double gain);
  /// Notes that a full fit has refused a form, and why.
  void refused(const Screened& screened, const Judged& judged);
  /// Forms that full fits have refused again and again, and that promise no more now, keep their refusal.
  void recall(Answers& answers) const;

 private:
  struct Refusal {
    int times{};
    double gain{};
    Judged judged{};
  };
  std::map<const model::Effect*, double> kept_;
  std::map<std::pair<const model::Effect*, int>, Refusal> refused_;
};

/// Which candidates are meant: all, those that nothing speaks against yet, or those that were found from afar.
enum class Which { kAll, kOpen, kFromAfar };

/// The best form of each effect that may matter and has not been fitted, those that promise most first.
[[nodiscard]] std::vector<std::size_t> worth_fitting(const Answers& answers, const Promises& promises,
                                                     const Settings& settings, Which which);

/// Says of candidates that no full fit has judged that it is so.
void name_unfitted(Answers& answers);

/// Where the fit of an answer to `problem` begins.
[[nodiscard]] model::Model start_of(const identification::TrajectoryFit& problem, const identification::FitResult& fit,
                                    const Screened& screened);

}  // namespace fathom::diagnosis
