#include "common/learning/pick_groups.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <span>

#include "common/base/parallel.hpp"
#include "common/inference/feature_screen.hpp"
#include "common/learning/moments.hpp"
#include "common/learning/products.hpp"
#include "common/learning/profile_inner.hpp"
#include "common/learning/within_factor.hpp"

namespace fathom::learning {
namespace {

using inference::ColumnRange;
using inference::GroupEvidence;
using inference::price;
using inference::Seen;
using likelihood::Feature;

constexpr std::size_t kShortlist = 24;  // groups whose products with all others are worked out
constexpr std::size_t kProfiled = 4;    // of those whose moment, place or length is sought more closely
constexpr double kWorthMoving = 5.0;    // nats, no price paid: what promises less where it stands is left there

/// A group of the force that is in the model already.
bool held(const Seen& seen, const likelihood::FreeForce& library, const likelihood::FeatureGroup& group) {
  const auto features = [](const likelihood::FreeForce& force, const likelihood::FeatureGroup& of) {
    return std::span{force.features}.subspan(static_cast<std::size_t>(of.first), static_cast<std::size_t>(of.count));
  };
  const likelihood::FreeForce& force = seen.fit.hypothesis.force;
  return !group.searched && std::ranges::any_of(force.groups, [&](const likelihood::FeatureGroup& other) {
    return std::ranges::equal(features(force, other), features(library, group), [](const auto& a, const auto& b) {
      return a.axis == b.axis && a.count == b.count && a.factors == b.factors;
    });
  });
}

/// Along each direction, of groups with inner numbers those that promise most are moved to where they are most likely,
/// and the best of them stands for all: what stands beside it has come, or would come, to the same place. What is left
/// beside it shows in the next round. `shortlist`: the best first. Returned are those that it stands for.
std::vector<std::size_t> moved_to_their_places(const likelihood::Problem& problem, const Seen& seen,
                                               const model::Scene& scene, int threads,
                                               const std::vector<std::size_t>& shortlist, std::vector<double>& alone,
                                               likelihood::FreeForce& library) {
  const auto of = [&](std::size_t g) -> const likelihood::FeatureGroup& { return library.groups[g]; };
  const auto paid = [&](std::size_t g) { return price(of(g), library.groups.size(), inference::Thresholds{}); };
  std::map<int, std::vector<std::size_t>> along;
  for (const std::size_t g : shortlist) {
    const Feature& first = library.features[static_cast<std::size_t>(of(g).first)];
    if (of(g).closed && factor_with_inner(first) != nullptr) along[of(g).axis].push_back(g);
  }
  std::vector<std::size_t> moved;
  for (const auto& [axis, groups] : along) {
    for (std::size_t k = 0; k < std::min(groups.size(), kProfiled); ++k) {
      if (axis == model::kPull || alone[groups[k]] + paid(groups[k]) > kWorthMoving) moved.push_back(groups[k]);
    }
  }
  std::map<int, std::size_t> best;
  for (const auto& [g, evidence] : profile_inner(problem, seen, scene, Room{problem}, moved, library, threads)) {
    alone[g] = evidence - paid(g);
    const auto [place, fresh] = best.try_emplace(of(g).axis, g);
    if (!fresh && alone[g] > alone[place->second]) place->second = g;
  }
  std::vector<std::size_t> stood_for;
  for (const auto& [axis, g] : best)
    std::ranges::copy_if(along[axis], std::back_inserter(stood_for), [&](std::size_t other) { return other != g; });
  return stood_for;
}

}  // namespace

Picked pick_groups(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                   const Picking& how) {
  likelihood::FreeForce library = products_of(problem, seen, scene, how.clock);
  const std::size_t all = library.groups.size();
  const inference::Thresholds thresholds;
  std::vector<double> alone(all);
  const std::vector<std::vector<std::size_t>> batches = inference::batches_of(library);
  for_each_index(batches.size(), how.threads, [&](std::size_t b) {
    const inference::Screen several = inference::screen(problem, seen, library, batches[b], false);
    for (std::size_t k = 0; k < batches[b].size(); ++k) {
      const std::size_t g = batches[b][k];
      alone[g] = inference::group_evidence(several.gram, several.gradient, std::span{several.ranges}.subspan(k, 1),
                                           {inference::kStartSigma})
                     .log_bayes_factor -
                 price(library.groups[g], all, thresholds);
    }
  });
  std::vector<std::size_t> shortlist;
  for (std::size_t g = 0; g < all; ++g) {
    if (!held(seen, library, library.groups[g])) shortlist.push_back(g);
  }
  if (shortlist.empty()) return {.among = all};
  const auto best_first = [&] {
    std::ranges::stable_sort(shortlist, std::greater{}, [&](std::size_t g) { return alone[g]; });
  };
  best_first();
  std::vector<std::size_t> begun;
  for (const std::size_t g : shortlist) {
    if (begun.size() == kProfiled) break;
    const likelihood::FeatureGroup& group = library.groups[g];
    if (group.searched && sets_in(library.features[static_cast<std::size_t>(group.first)])) begun.push_back(g);
  }
  for (const auto& [g, evidence] : profile_moments(problem, seen, begun, library, how.threads))
    alone[g] = evidence - price(library.groups[g], all, thresholds);
  for (const std::size_t g : moved_to_their_places(problem, seen, scene, how.threads, shortlist, alone, library))
    std::erase(shortlist, g);
  best_first();
  shortlist.resize(std::min(shortlist.size(), kShortlist));
  const inference::Screen whole = inference::screen(problem, seen, library, shortlist, true);
  const auto price_of = [&](std::size_t k) { return price(library.groups[whole.groups[k]], all, thresholds); };
  const auto evidence_of = [&](const std::vector<std::size_t>& of, std::vector<double> sigma) {
    std::vector<ColumnRange> ranges;
    for (const std::size_t k : of) ranges.push_back(whole.ranges[k]);
    return inference::group_evidence(whole.gram, whole.gradient, ranges, std::move(sigma));
  };
  std::vector<std::size_t> picked;
  GroupEvidence evidence;
  double priced = 0.0;
  while (picked.size() < how.most) {
    double best = thresholds.group_gain;
    std::size_t taken = shortlist.size();
    GroupEvidence of_best;
    for (std::size_t k = 0; k < shortlist.size(); ++k) {
      if (std::ranges::find(picked, k) != picked.end()) continue;
      std::vector<std::size_t> of = picked;
      of.push_back(k);
      std::vector<double> sigma = evidence.sigma;
      sigma.push_back(inference::kStartSigma);
      GroupEvidence with = evidence_of(of, std::move(sigma));
      const double gain = with.log_bayes_factor - evidence.log_bayes_factor - price_of(k);
      if (gain <= best) continue;
      best = gain;
      taken = k;
      of_best = std::move(with);
    }
    if (taken == shortlist.size()) break;
    picked.push_back(taken);
    priced += price_of(taken);
    evidence = std::move(of_best);
    for (std::size_t k = 0; k + 1 < picked.size();) {  // the one that was just taken up stays
      std::vector<std::size_t> of = picked;
      std::vector<double> sigma = evidence.sigma;
      of.erase(of.begin() + static_cast<std::ptrdiff_t>(k));
      sigma.erase(sigma.begin() + static_cast<std::ptrdiff_t>(k));
      GroupEvidence without = evidence_of(of, std::move(sigma));
      if (without.log_bayes_factor + price_of(picked[k]) <= evidence.log_bayes_factor) {
        ++k;
        continue;
      }
      priced -= price_of(picked[k]);
      picked = std::move(of);
      evidence = std::move(without);
    }
  }
  // Where nothing stands out, the best is fitted all the same: the fitted random force may have swallowed it.
  if (picked.empty() && how.at_least_one && how.most > 0) {
    picked.push_back(0);
    priced = price_of(0);
    evidence = evidence_of(picked, {inference::kStartSigma});
  }
  if (picked.empty()) return {.among = all};
  return {inference::chosen(library, whole, picked, evidence), evidence.log_bayes_factor - priced, all};
}

}  // namespace fathom::learning
