#include "common/consistency/pairs/pair_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kDelayFloor = 0.010;     // s: a smaller disagreement does not change a fitted model
constexpr double kPracticalDelay = 0.05;  // s: such a delay bends a fitted inertia or lag
constexpr double kColumnSeen = 8.0;       // |column of M| over its sigma: below, nothing is said about the axis

}  // namespace

void Comparison::see_columns() {
  std::vector<double> explained;
  seen_.assign(runs_.size(), {false, false, false});
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!fit(r).ok || fit(r).theta_replicates.empty() || fit(r).explained < kLeastExplained) continue;
    for (int k = 0; k < 3; ++k) {
      double sigma = 0.0;
      for (int i = 0; i < 3; ++i) {
        const auto element = [&](const Eigen::VectorXd& theta) { return theta[3 * k + i]; };
        sigma = std::max(sigma, estimate(fit(r), element, false).sigma);
      }
      seen_[r][static_cast<std::size_t>(k)] = fit(r).theta.segment<3>(3 * k).norm() > kColumnSeen * sigma;
    }
    explained.push_back(fit(r).explained);
  }
  result_.checked = !explained.empty();
  result_.explained = median(std::move(explained));
}

void Comparison::report(const SharedValue& decision, const std::string& signal, const std::string& finding,
                        const std::string& unit, double neutral, double practical, const std::string& action,
                        const std::string& more) {
  const bool measured = decision.pooled.count > 0;
  Statement statement{
      .signal = signal,
      .reference = names_.reference,
      .quantity = finding == "unit" ? "scale" : finding,
      .unit = unit,
      .value = measured ? decision.pooled.value : neutral,
      .sigma = measured ? decision.pooled.sigma : std::numeric_limits<double>::infinity(),
      .neutral = neutral,
      .seen = measured ? decision.limit * decision.pooled.sigma : std::numeric_limits<double>::infinity(),
      .practical = practical};
  const double most = std::abs(statement.value - neutral) + statement.seen;
  statement.answer = decision.found || !decision.different.empty()          ? Answer::kDisagree
                     : statement.seen < practical && most < 2.0 * practical ? Answer::kAgree
                                                                            : Answer::kCannotTell;
  result_.statements.push_back(std::move(statement));
  if (decision.found) {
    result_.findings.push_back(
        {.run = "all",
         .signal = signal,
         .reference = names_.reference,
         .finding = finding,
         .size = decision.pooled.value,
         .unit = unit,
         .evidence = text("%.5g +- %.2g (1 sigma)", decision.pooled.value, decision.pooled.sigma) + " " + unit +
                     ", from " + std::to_string(decision.pooled.count) + " recordings" + more,
         .action = action,
         .std = decision.pooled.sigma,
         .freedom = decision.freedom});
  }
  for (const std::size_t r : decision.different) {
    result_.findings.push_back(
        {.run = runs_[r],
         .signal = signal,
         .reference = names_.reference,
         .finding = finding,
         .size = decision.applied[r],
         .unit = unit,
         .evidence = (decision.disagree ? text("%.5g here, %.5g over all recordings, which disagree: ",
                                               decision.applied[r], decision.pooled.value)
                                        : text("%.5g here, %.5g in the other recordings ", decision.applied[r],
                                               decision.found ? decision.pooled.value : neutral)) +
                     unit + more,
         .action = action + (decision.disagree ? ", each recording by its own number" : ", in this recording only")});
  }
}

void Comparison::find_delay() {
  std::vector<Estimate> estimates(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!fit(r).ok || !fit(r).delay_found || fit(r).explained < kLeastExplained) continue;
    estimates[r] = estimate_delay(fit(r));
    estimates[r].informative = estimates[r].sigma < 0.05;
  }
  const SharedValue decision = share(estimates, 0.0, kDelayFloor);
  report(decision, names_.signal, "delay", "s", 0.0, kPracticalDelay, "corrected: clocks aligned",
         decision.pooled.value > 0.0 ? "; lags " + names_.reference : "; leads " + names_.reference);
  for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].delay = decision.applied[r];
}

PairResult Comparison::run() {
  see_columns();
  if (!result_.checked) return std::move(result_);
  find_axes();
  find_delay();
  find_scales();
  find_turns();
  find_offsets();
  return std::move(result_);
}

PairResult compare(const PairNames& names, std::span<const std::string> runs, std::vector<IncrementFit> fits) {
  return Comparison(names, runs, std::move(fits)).run();
}

}  // namespace fathom::consistency
