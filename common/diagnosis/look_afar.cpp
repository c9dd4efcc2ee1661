#include "common/diagnosis/look_afar.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/identification/fit_from_priors.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr std::size_t kFewWindows = 20;   // enough to tell whether a start leads anywhere
constexpr double kQuickTolerance = 1e-3;  // relative decrease of the cost
constexpr double kSamePlace = 0.02;       // of a number's scale, where the number is no larger than that

/// Whether two fits have ended at the same numbers, as well as quick ones can.
bool alike(const model::Model& one, const model::Model& other) {
  const identification::ParameterMap map{one};
  const Eigen::ArrayXd a = map.pack(one).array(), b = map.pack(other).array();
  return ((a - b).abs() < kSamePlace * a.abs().max(1.0)).all();
}

/// First fits with a candidate, on windows so short that they cost little and that no beginning is too far from them.
/// What is large shows there too; what gains nothing there is let go.
class FirstFits {
 public:
  FirstFits(const model::Vehicle& vehicle, std::span<const Trial> train, const identification::FitSettings& few,
            const model::Model& fitted)
      : nominal_{model::nominal_model(vehicle, train[0].input_is_wrench).theta},
        shortest_{identification::shortest_windows(vehicle, train, few)},
        without_{shortest_.fit(fitted)} {}

  /// Models that remove `least` of the error. The base numbers begin where the fit without the candidate has them, and
  /// at the vehicle file's: beside an effect that is not known they may have gone as far astray as the effect is from
  /// absence, and no step leads back.
  [[nodiscard]] std::vector<model::Model> worthy(model::Model start, double least) const {
    std::vector<model::Model> found;
    const model::BaseTheta fitted = start.theta;
    for (const model::BaseTheta& theta : {fitted, nominal_}) {
      start.theta = theta;
      FitResult with = shortest_.fit(start, &without_, kQuickTolerance);
      const bool there_before = !found.empty() && alike(found.front(), with.model);
      if (!there_before && reduction(without_.cost, with.cost) >= least) found.push_back(std::move(with.model));
    }
    return found;
  }

 private:
  model::BaseTheta nominal_;
  TrajectoryFit shortest_;
  FitResult without_;
};

}  // namespace

void look_afar(Answers& answers, const TrajectoryFit& problem, std::span<const Trial> train, const Settings& settings,
               const FitResult& fit, const model::Scene& scene, const Progress& progress, double done) {
  Coarse coarse{problem, train, settings, fit, kFewWindows};
  std::optional<FirstFits> first;
  for (std::size_t i = 0; i < answers.screened.size(); ++i) {
    const Screened& candidate = answers.near[i];
    for (const std::vector<double>& start : candidate.effect->far_starts(scene, candidate.variant)) {
      progress("looking further at " + std::string(candidate.effect->name()), done);
      const identification::FitSettings& few = coarse.problem().settings();
      if (!first) first.emplace(problem.vehicle(), train, few, fit.model);
      model::Model model = fit.model;
      model.add({candidate.effect, candidate.variant, candidate.variant_name, start});
      for (const model::Model& begin : first->worthy(std::move(model), settings.smallest_reduction)) {
        const FitResult longer = identification::fit_by_longer_windows(problem.vehicle(), train, few, begin);
        FitResult far = coarse.problem().fit(longer.model, &coarse.reference(), kQuickTolerance);
        const double share = reduction(coarse.reference().cost, far.cost);
        if (share <= answers.share[i]) continue;
        answers.share[i] = share;
        answers.found[i] = std::move(far.model);
        answers.fitted[i] = false;
      }
    }
  }
}

}  // namespace fathom::diagnosis
