#include "common/consistency/pairs/shared_value.hpp"

#include <cmath>

#include "common/base/distributions.hpp"

namespace fathom::consistency {
namespace {

constexpr double kByChance = 2e-5;  // a check asks some forty numbers: one false finding in a thousand checks

constexpr double kApart = 3.0;  // floors by which values must differ before it matters

double limit_of(double freedom) { return std::sqrt(f_quantile(kByChance, std::max(freedom, 1.0))); }

/// Whether one of the used estimates contradicts the mean of the others.
bool contradict(std::span<const Estimate> estimates, const std::vector<std::size_t>& used, double floor) {
  for (const std::size_t one : used) {
    std::vector<double> values, sigmas;
    double freedom = estimates[one].freedom;
    for (const std::size_t other : used) {
      if (other == one) continue;
      values.push_back(estimates[other].value);
      sigmas.push_back(estimates[other].sigma);
      freedom += estimates[other].freedom;
    }
    const Pooled others = pool(values, sigmas);
    const double off = std::abs(estimates[one].value - others.value);
    if (off > kApart * floor && off > limit_of(freedom) * std::hypot(estimates[one].sigma, others.sigma)) return true;
  }
  return false;
}

}  // namespace

SharedValue share(std::span<const Estimate> estimates, double neutral, double floor) {
  SharedValue decision;
  decision.applied.assign(estimates.size(), neutral);
  std::vector<std::size_t> used;
  std::vector<double> all;
  for (std::size_t r = 0; r < estimates.size(); ++r) {
    if (!estimates[r].informative || !std::isfinite(estimates[r].sigma) || estimates[r].sigma <= 0.0) continue;
    used.push_back(r);
    all.push_back(estimates[r].value);
  }
  // A recording unlike the others: only a majority can say so.
  if (used.size() >= 3) {
    const double centre = median(all);
    const double spread = mad_sigma(all);
    std::vector<std::size_t> alike;
    for (const std::size_t r : used) {
      const double off = std::abs(estimates[r].value - centre);
      if (off > 3.0 * floor && off > 6.0 * std::hypot(estimates[r].sigma, spread)) {
        decision.different.push_back(r);
      } else {
        alike.push_back(r);
      }
    }
    if (2 * alike.size() > used.size()) {
      used = alike;
    } else {
      decision.different.clear();
    }
  }
  if (used.size() >= 2 && contradict(estimates, used, floor)) {
    decision.disagree = true;
    for (const std::size_t r : used) {
      const Estimate& one = estimates[r];
      const double size = std::abs(one.value - neutral);
      if (size < floor || size < limit_of(one.freedom) * one.sigma) continue;
      decision.different.push_back(r);
    }
  }
  std::vector<double> values, sigmas;
  int positive = 0, negative = 0;
  for (const std::size_t r : used) {
    values.push_back(estimates[r].value - neutral);
    sigmas.push_back(estimates[r].sigma);
    decision.freedom += estimates[r].freedom;
    (values.back() > 0.0 ? positive : negative) += 1;
  }
  decision.pooled = pool(values, sigmas);
  if (used.empty()) return decision;
  // Student's tail: few blocks of data know their own scatter badly.
  decision.limit = limit_of(decision.freedom);
  const double size = std::abs(decision.pooled.value);
  const int same = decision.pooled.value > 0.0 ? positive : negative;
  const bool repeated = used.size() < 3 ? same == static_cast<int>(used.size()) : same >= 3;
  decision.found = !decision.disagree && size > decision.limit * decision.pooled.sigma && size > floor && repeated;
  decision.pooled.value += neutral;
  if (decision.found) decision.applied.assign(estimates.size(), decision.pooled.value);
  for (const std::size_t r : decision.different) decision.applied[r] = estimates[r].value;
  return decision;
}

}  // namespace fathom::consistency
