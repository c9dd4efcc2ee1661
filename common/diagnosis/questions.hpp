// "Could you be this?", asked of every form of every effect: a quick look on a spread of windows, a careful one at
// those that promise something.
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
  std::vector<Screened> near;      ///< by windows so short that the base model cannot go far astray in them
  std::vector<Screened> screened;  ///< by whole windows; empty until they have been asked
  std::vector<double> share;       ///< of the error (RMS) that it promises to remove, by whichever promises more
  std::vector<Judged> judged;      ///< by the screening until a fit has told, refusals included
  std::vector<bool> fitted;        ///< in full
  std::vector<std::optional<model::Model>>
      found;                    ///< where a full fit should begin, when known better than by screening
  Eigen::VectorXd unexplained;  ///< all residuals of the short windows, as the screening saw them
  Eigen::VectorXi axis;         ///< 0..5, of each of them
  double cost{};                ///< of all
};

/// The problem on short windows and its own fit of the model that is asked about. What lacks an effect bends long
/// trajectories until nothing linear can be said about them; short ones begin anew from what was measured.
struct NearView {
  NearView(const model::Vehicle& vehicle, std::span<const Trial> train, const Settings& settings);
  void fit(const model::Model& model);

  identification::TrajectoryFit problem;
  identification::FitResult reference;
};

/// Those of `candidates` that the model does not hold are asked, by short windows.
[[nodiscard]] Answers ask_near(std::span<const Candidate> candidates, const NearView& near, const model::Scene& scene,
                               const Settings& settings);
/// The same candidates are asked by whole windows: what acts slowly shows there alone.
void ask_whole(Answers& answers, const identification::TrajectoryFit& problem, const identification::FitResult& fit,
               const model::Scene& scene, int tried, const Settings& settings);

/// The same problem on a spread of windows, made when it is first asked for: enough to tell whether a full fit leads
/// anywhere. What it is made from must outlive it.
class Coarse {
 public:
  /// On at most `windows` of them.
  Coarse(const identification::TrajectoryFit& whole, std::span<const Trial> train, const Settings& settings,
         const identification::FitResult& fit, std::size_t windows = kCoarseWindows);
  /// False when all windows are hardly more.
  [[nodiscard]] bool useful() const;
  [[nodiscard]] const identification::TrajectoryFit& problem();
  /// The fit without a candidate.
  [[nodiscard]] const identification::FitResult& reference();

  static constexpr std::size_t kCoarseWindows = 40;  // enough to tell whether a form leads anywhere

 private:
  const identification::TrajectoryFit& whole_;
  std::span<const Trial> train_;
  const Settings& settings_;
  const identification::FitResult& fit_;
  std::size_t windows_;
  std::optional<identification::TrajectoryFit> problem_;
  identification::FitResult like_, reference_;
};

/// How much of what the screening promised a full fit has kept, effect by effect. For some effects the linear picture
/// flatters: large masses and onsets imitate what the base model can do by itself.
class Promises {
 public:
  /// What may come of a promised share of the error.
  [[nodiscard]] double expected(const Answers& answers, std::size_t candidate) const;
  /// Notes the share that a full fit has removed.
  void kept(const Answers& answers, std::size_t candidate, double share);
  /// Notes that a full fit has refused a form, and why.
  void refused(const Answers& answers, std::size_t candidate);
  /// Forms that full fits have refused again and again, and that promise no more now, keep their refusal.
  void recall(Answers& answers) const;

 private:
  struct Refusal {
    int times{};
    double share{};
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

/// Where the fit of an answer to `problem` begins: the best of what the screenings propose.
[[nodiscard]] model::Model start_of(const identification::TrajectoryFit& problem, const identification::FitResult& fit,
                                    const Answers& answers, std::size_t candidate);

}  // namespace fathom::diagnosis
