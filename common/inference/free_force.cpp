#include "common/inference/free_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.hpp"
#include "common/inference/feature_library.hpp"
#include "common/inference/feature_screen.hpp"

namespace fathom::inference {
namespace {

constexpr std::size_t kShortlist = 14;  // groups whose products with all others are worked out
constexpr double kFactor = 4.0;         // by which the second start's random force is smaller
constexpr double kSettled = 4.0;        // times the odds that are needed: no second start could change the verdict

}  // namespace

std::string words(const GroupFound& group) {
  if (group.axis >= likelihood::kWorldAxis) return group.kind;
  return group.kind + " in " + model::kAxisNames[static_cast<std::size_t>(group.axis)];
}

FreeForceFound find_free_force(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                               const Thresholds& thresholds, int threads, const Deadline& deadline) {
  FreeForceFound found;
  const likelihood::FreeForce library = feature_library(problem, seen, scene);
  const std::size_t all = library.groups.size();
  if (all == 0) return found;

  // Each group alone; the best of them with all their products.
  std::vector<double> alone(all, 0.0);
  const std::vector<std::vector<std::size_t>> batches = batches_of(library);
  for_each_index(batches.size(), threads, [&](std::size_t b) {
    const Screen several = screen(problem, seen, library, batches[b], false);
    for (std::size_t k = 0; k < batches[b].size(); ++k) {
      const std::size_t g = batches[b][k];
      alone[g] = group_evidence(several.gram, several.gradient, std::span{several.ranges}.subspan(k, 1), {kStartSigma})
                     .log_bayes_factor -
                 price(library.groups[g], all, thresholds);
    }
  });
  std::vector<std::size_t> shortlist(all);
  for (std::size_t g = 0; g < all; ++g) shortlist[g] = g;
  std::ranges::sort(shortlist, std::greater{}, [&](std::size_t g) { return alone[g]; });
  shortlist.resize(std::min(all, kShortlist));
  const Screen whole = screen(problem, seen, library, shortlist, true);

  std::vector<std::size_t> picked;
  GroupEvidence evidence;
  double priced = 0.0;
  while (static_cast<int>(picked.size()) < thresholds.most_groups) {
    double best = thresholds.group_gain;
    std::size_t taken = shortlist.size();
    GroupEvidence of_best;
    for (std::size_t k = 0; k < shortlist.size(); ++k) {
      if (std::ranges::find(picked, k) != picked.end()) continue;
      std::vector<ColumnRange> ranges;
      for (const std::size_t other : picked) ranges.push_back(whole.ranges[other]);
      ranges.push_back(whole.ranges[k]);
      std::vector<double> sigma = evidence.sigma;
      sigma.push_back(kStartSigma);
      GroupEvidence with = group_evidence(whole.gram, whole.gradient, ranges, sigma);
      const double gain =
          with.log_bayes_factor - evidence.log_bayes_factor - price(library.groups[whole.groups[k]], all, thresholds);
      if (gain <= best) continue;
      best = gain;
      taken = k;
      of_best = std::move(with);
    }
    if (taken == shortlist.size()) break;
    const likelihood::FeatureGroup& group = library.groups[whole.groups[taken]];
    found.groups.push_back({group.kind, group.axis, best});
    priced += price(group, all, thresholds);
    picked.push_back(taken);
    evidence = std::move(of_best);
  }
  // Where nothing stands out, the best is fitted all the same: the fitted random force may have swallowed it.
  if (picked.empty()) {
    picked.push_back(0);
    const likelihood::FeatureGroup& group = library.groups[whole.groups[0]];
    evidence = group_evidence(whole.gram, whole.gradient, std::span{whole.ranges}.first(1), {kStartSigma});
    priced = price(group, all, thresholds);
    found.groups.push_back({group.kind, group.axis, evidence.log_bayes_factor - priced});
  }
  found.at_fixed_noise = evidence.log_bayes_factor - priced;
  found.log_odds = found.at_fixed_noise;

  // Noise fitted anew beside it, from the noise as it is and from a smaller random force.
  const bool settled = found.at_fixed_noise > kSettled * thresholds.free_force_odds;
  std::vector<likelihood::Fit> fits(deadline.over() ? 0 : settled ? 1 : 2);
  for_each_index(fits.size(), threads, [&](std::size_t start) {
    likelihood::Hypothesis hypothesis = seen.fit.hypothesis;
    hypothesis.force = chosen(library, whole, picked, evidence);
    likelihood::Noise noise = seen.fit.noise;
    for (likelihood::AxisNoise& axis : noise) axis.log[likelihood::kForce] -= start == 0 ? 0.0 : std::log(kFactor);
    likelihood::FitOptions options{.noise_rounds = 2, .steps = 2, .enough = 0.3};
    if (fits.size() == 1) options.threads = threads;
    // The screen is linear: where its weights run away in the filter, the fit begins from smaller ones.
    likelihood::Fit fitted;
    for (const double share : {1.0, 0.3, 0.0}) {
      likelihood::Hypothesis smaller = hypothesis;
      for (double& weight : smaller.force.weights) weight *= share;
      fitted = likelihood::fit(problem, smaller, noise, options);
      if (fitted.finite) break;
    }
    if (fitted.finite) {
      renew_sigmas(fitted);
      options.noise_rounds = 1;
      const likelihood::Fit again = likelihood::fit(problem, fitted.hypothesis, fitted.noise, options);
      if (again.finite) fitted = again;
    }
    fits[start] = std::move(fitted);
  });
  for (likelihood::Fit& fit : fits) {
    if (!fit.finite) continue;
    const double odds = fit.log_evidence - seen.fit.log_evidence - priced;
    if (found.fit.finite && fit.log_evidence <= found.fit.log_evidence) continue;
    found.log_odds = odds;
    found.fit = std::move(fit);
  }
  // What the screen promises and no fit keeps is not found.
  if (!fits.empty() && !found.fit.finite) found.log_odds = std::min(found.log_odds, 0.0);

  for (std::size_t i = 0; i < static_cast<std::size_t>(problem.simulated) && found.fit.finite; ++i) {
    const double left = found.fit.noise[i][likelihood::kForce] / seen.fit.noise[i][likelihood::kForce];
    found.explainable.push_back(std::max(0.0, 1.0 - left * left));
  }
  found.size = size_of_force(problem, seen,
                             found.fit.finite ? found.fit.hypothesis.force : chosen(library, whole, picked, evidence));
  return found;
}

}  // namespace fathom::inference
