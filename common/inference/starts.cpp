#include "common/inference/starts.hpp"

#include <algorithm>

namespace fathom::inference {
namespace {

constexpr double kLost = 1.0;  // nats of each measured number: innovations nearly twice as large, and no small step
constexpr double kShorter = 0.25;
constexpr int kMostShorter = 6;  // a fourth of a thousandth is next to nothing

bool same_form(const model::ActiveEffect& a, const model::ActiveEffect& b) {
  return a.effect == b.effect && a.variant == b.variant;
}

}  // namespace

Start start_of(const likelihood::Problem& problem, const std::vector<Law>& laws, const likelihood::Hypothesis& from,
               const std::vector<model::ActiveEffect>& added, const likelihood::Noise& noise) {
  const auto see_once = [&](const likelihood::Hypothesis& hypothesis) {
    return pass(problem, hypothesis, {}, noise, {.derivatives = false});
  };
  Start start{from, noise};
  for (const model::ActiveEffect& active : added) start.hypothesis.model.add(active);
  const likelihood::PassResult without = see_once(from);
  const double least = without.log_likelihood - kLost * without.scored;
  for (int k = 0; k < kMostShorter; ++k) {
    const likelihood::PassResult here = see_once(start.hypothesis);
    if (here.finite && here.log_likelihood >= least) break;
    for (model::ActiveEffect& active : start.hypothesis.model.effects) {
      const auto law = std::ranges::find_if(laws, [&](const Law& one) { return same_form(one.seed, active); });
      if (law == laws.end() || std::ranges::none_of(added, [&](const auto& one) { return same_form(one, active); }))
        continue;
      for (const std::size_t c : law->linear) active.theta[c] *= kShorter;
    }
  }
  return start;
}

}  // namespace fathom::inference
