// What promises most beside a model, and what of that is asked.
#include <algorithm>
#include <cmath>

#include "common/base/parallel.hpp"
#include "common/inference/searching.hpp"
#include "common/inference/starts.hpp"

namespace fathom::inference {
namespace {

constexpr double kLouder = 5.0;  // by which the second scan's random force is smaller

}  // namespace

std::vector<Proposal> Searching::proposals(const Fitted& from, double least, bool with_pairs) {
  std::vector<Proposal> proposals;
  promised_.clear();
  unasked_.clear();
  const auto take = [&](const Scan& scan, const likelihood::Noise& noise) {
    const double best = scan.promises.empty() ? 0.0 : scan.promises.front().score;
    int singles = 0;
    std::map<std::string, int> of_name;
    for (const Promise& promise : scan.promises) {
      note(promise);
      const bool first = asked_first(laws_[promise.law]);
      if (promise.score < least || of_name[laws_[promise.law].name]++ > 0) continue;  // the best form of each
      const bool far = promise.score < kFarBehind * best;
      if (!first && (far || singles++ >= (sought_ ? 1 : thresholds_.fits_per_round))) {
        unasked_.push_back({promise.score, far, {{effect_of(promise.law, promise.theta)}, noise, false, {}}});
        continue;
      }
      proposals.push_back({{effect_of(promise.law, promise.theta)}, noise, first, {}});
      for (const std::vector<double>& theta : sought_ ? std::vector<std::vector<double>>{} : promise.also)
        proposals.back().also.push_back(effect_of(promise.law, theta));
    }
    int pairs = 0;
    for (const PairPromise& pair : scan.pairs) {
      if (!with_pairs || pairs >= thresholds_.pairs_per_round || pair.score < best + thresholds_.pair_gain) break;
      proposals.push_back({{effect_of(scan.promises[pair.first].law, pair.theta_first),
                            effect_of(scan.promises[pair.second].law, pair.theta_second)},
                           noise});
      ++pairs;
    }
  };
  begin(kScan);
  const Seen seen = see(problem_, from.fit, threads_);
  take(scan(problem_, seen, laws_, thresholds_, threads_), from.fit.noise);
  likelihood::Fit quiet = from.fit;
  if (quieten(seen, quiet)) {
    const Seen again = see(problem_, quiet, threads_);
    take(scan(problem_, again, laws_, thresholds_, threads_), quiet.noise);
  }
  progress_.done(kScan.phase);
  // One fit of each set of forms.
  std::vector<Proposal> unlike;
  for (Proposal& proposal : proposals) {
    const bool same = std::ranges::any_of(unlike, [&](const Proposal& other) {
      return other.added.size() == proposal.added.size() &&
             std::ranges::equal(other.added, proposal.added, [](const auto& a, const auto& b) {
               return a.effect == b.effect && a.variant == b.variant;
             });
    });
    if (!same) unlike.push_back(std::move(proposal));
  }
  for (std::size_t k = 0, count = unlike.size(); k < count; ++k) {
    for (const model::ActiveEffect& active : std::vector{unlike[k].also})
      unlike.push_back({{active}, unlike[k].noise, unlike[k].first, {}});
  }
  return unlike;
}

std::vector<Proposal> Searching::hidden(const std::vector<Proposal>& asked, double gained) const {
  std::vector<Unasked> order = unasked_;
  std::ranges::stable_sort(order, std::greater{}, &Unasked::promised);
  std::vector<Proposal> found;
  int far = 0;
  for (Unasked& one : order) {
    const auto same = [&](const Proposal& other) {
      return other.added.size() == 1 && other.added.front().effect == one.proposal.added.front().effect;
    };
    if (one.promised < gained &&
        (!one.far || one.promised < kFarBehind * gained || far++ >= thresholds_.fits_per_round))
      continue;
    if (std::ranges::none_of(asked, same) && std::ranges::none_of(found, same))
      found.push_back(std::move(one.proposal));
  }
  return found;
}

std::vector<Start> Searching::starts(const likelihood::Hypothesis& from, const std::vector<Proposal>& proposals) const {
  std::vector<Start> starts(proposals.size());
  for_each_index(starts.size(), threads_, [&](std::size_t i) {
    starts[i] = start_of(problem_, laws_, from, proposals[i].added, proposals[i].noise);
  });
  return starts;
}

void Searching::quiet(likelihood::Fit& fit) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i)
    fit.noise[i].log[likelihood::kForce] -= std::log(kLouder);
}

bool Searching::quieten(const Seen& seen, likelihood::Fit& fit) const {
  bool large = false;
  for (int i = 0; i < problem_.simulated; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    large =
        large || (fit.noise[axis][likelihood::kForce] > thresholds_.large_random * seen.applied[problem_.axes[axis]] &&
                  fit.noise[axis][likelihood::kForceMemory] > thresholds_.swallowing_memory);
  }
  if (large) quiet(fit);
  return large;
}

}  // namespace fathom::inference
