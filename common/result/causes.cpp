#include "common/result/causes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "common/diagnosis/diagnoser.hpp"
#include "common/diagnosis/foretold.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/left_over.hpp"
#include "common/diagnosis/rivals.hpp"
#include "common/diagnosis/verdict.hpp"
#include "common/identification/parameter_map.hpp"
#include "common/residual/prediction.hpp"

namespace fathom::result {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kHalf =
    0.5;  // of an axis' applied wrench (residual/whiteness.hpp), of the error (preflight/wiring.hpp)

double probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

/// The axes of which the model foretells less than their average, and those whose thrust it does not follow.
void axes(const DiagnosisResult& result, std::vector<CauseGiven>& causes) {
  const std::vector<diagnosis::Foretold> foretold = diagnosis::badly_foretold(result);
  for (const diagnosis::Foretold& axis : foretold) {
    if (axis.blind) causes.push_back({"no_prediction", axis.share, 0.0, axis.axis});
  }
  for (const std::string& axis : diagnosis::not_followed(result, foretold)) {
    const auto found = std::ranges::find(result.residual_after, axis, &AxisWhiteness::axis);
    causes.push_back({"thrust_not_followed", found->explained, kHalf, axis});
  }
}

void residual(const DiagnosisResult& result, std::vector<CauseGiven>& causes) {
  for (const Association& one : result.goes_with)
    causes.push_back(
        {"residual_goes_with", one.share, diagnosis::kSmallestAssociation, one.axis + " with " + one.with});
  for (const CandidateTried& one : result.candidates) {
    if (one.reason == diagnosis::kNotCarriedOver) causes.push_back({"not_carried_over", one.log_odds, kNone, one.name});
  }
  const auto most = std::ranges::max_element(result.candidates, {}, &CandidateTried::error_reduction);
  const bool refused = most != result.candidates.end() &&
                       std::ranges::find(result.effects, most->name, &EffectFound::name) == result.effects.end();
  if (refused && most->error_reduction >= diagnosis::kPromising)
    causes.push_back({"promising", most->error_reduction, diagnosis::kPromising, most->name});
}

void named(const DiagnosisResult& result, std::vector<CauseGiven>& causes) {
  const double needed = probability(diagnosis::kAlternativeLogOdds);
  for (const EffectFound& effect : result.effects) {
    double odds = effect.log_odds;
    std::string rivals;
    for (const Alternative& other : effect.alternatives) {
      rivals += (rivals.empty() ? " or " : ", ") + other.name;
      odds = std::min(odds, other.log_odds);
    }
    if (!effect.unlisted.empty()) rivals += (rivals.empty() ? " or " : ", ") + effect.unlisted;
    causes.push_back({rivals.empty() ? "named" : "rivals", probability(odds), needed, effect.name + rivals});
  }
}

}  // namespace

std::vector<CauseGiven> causes_of(const DiagnosisResult& result) {
  std::vector<CauseGiven> causes;
  if (result.wiring) {
    causes.push_back({"wiring", result.wiring->error_reduction, kHalf, result.wiring->readings.front()});
    return causes;
  }
  if (result.verdict == "unjudged") {
    causes.push_back({"too_short", kNone, residual::kHorizons.back(), ""});
    return causes;
  }
  const bool unexplained = result.verdict == "unexplained";
  if (unexplained) {
    axes(result, causes);
    residual(result, causes);
    if (!result.effects.empty() && result.explained < diagnosis::kWholeCause)
      causes.push_back({"part_only", result.explained, diagnosis::kWholeCause, ""});
    // Everything else that makes this verdict has been told.
    if (causes.empty()) causes.push_back({"free_curve", kNone, kNone, ""});
  }
  named(result, causes);
  if (!result.effects.empty() || unexplained) return causes;
  double best = 0.0;
  for (const CandidateTried& one : result.candidates) best = std::fmax(best, one.log_odds);
  causes.push_back({"nothing_found", best, diagnosis::Settings{}.accept_log_odds, ""});
  return causes;
}

void put_covariance(const identification::FitResult& fit, VerdictGiven& given) {
  const identification::ParameterMap map{fit.model};
  const auto size = static_cast<Eigen::Index>(map.size());
  if (fit.covariance.rows() != size || fit.covariance.cols() != size) return;
  std::vector<Eigen::Index> told;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const identification::FreeParameter& one = map[i];
    if (!one.sought) continue;
    if (one.effect >= 0) {
      const model::ActiveEffect& active = fit.model.effects[static_cast<std::size_t>(one.effect)];
      if (!active.effect->is_told(active.variant, static_cast<std::size_t>(one.component))) continue;
    }
    told.push_back(static_cast<Eigen::Index>(i));
    given.covariance_of.push_back(one.name);
  }
  for (const Eigen::Index i : told) {
    for (const Eigen::Index j : told) given.covariance.push_back(fit.covariance(i, j));
  }
}

}  // namespace fathom::result
