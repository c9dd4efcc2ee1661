#include "common/residual/unseen_event.hpp"

#include <algorithm>
#include <cmath>

#include "common/residual/force_residual.hpp"

namespace fathom::residual {
namespace {

constexpr double kFarMore = 2.0;      // times what is left in the fitted runs (RMS), from the event on
constexpr double kMemories = 3.0;     // samples that noise of so short a memory makes of one
constexpr double kEvident = 12.0;     // natural log of the likelihood ratio, those memories being allowed for
constexpr std::size_t kFewest = 40;   // samples of a run, and of the fitted ones
constexpr std::size_t kShortest = 8;  // samples that an event lasts, to the end of the run

constexpr double kLasting = 0.3;  // correlation of neighbours, beyond which more than noise is left

struct Sample {
  double t, left;
};

/// What is left along an axis, by samples that share no measurement.
std::vector<Sample> samples_of(const Trial& trial, std::span<const Vector6d> residual, Eigen::Index axis) {
  std::vector<Sample> samples;
  const std::size_t span = residual_span(trial.dt);
  for (std::size_t k = span / 2; k < residual.size(); k += span) {
    const double left = residual[k][axis];
    if (std::isfinite(left)) samples.push_back({trial.t[k], left});
  }
  return samples;
}

/// Where the log likelihood gains most if noise is larger from there on than `ordinary` (a mean square).
struct Change {
  double gain{};
  double t{};
};

Change largest_change(std::span<const Sample> samples, double ordinary) {
  Change best;
  double sum = 0.0;
  for (std::size_t n = 1; n <= samples.size(); ++n) {
    const Sample& first = samples[samples.size() - n];
    sum += first.left * first.left;
    const auto count = static_cast<double>(n);
    const double ratio = sum / (count * ordinary);
    if (n < kShortest || ratio < kFarMore * kFarMore) continue;
    const double gain = 0.5 * count * (ratio - 1.0 - std::log(ratio)) / kMemories;
    if (gain > best.gain) best = {gain, first.t};
  }
  return best;
}

/// Mean square of what is left in the fitted runs; zero where that is more than noise, or too little to tell.
double noise_of(std::span<const Trial> runs, std::span<const std::vector<Vector6d>> residuals, Eigen::Index axis) {
  double square = 0.0, product = 0.0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<Sample> samples = samples_of(runs[r], residuals[r], axis);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      square += samples[i].left * samples[i].left;
      if (i > 0) product += samples[i].left * samples[i - 1].left;
    }
    count += samples.size();
  }
  return count < kFewest || product > kLasting * square ? 0.0 : square / static_cast<double>(count);
}

}  // namespace

std::optional<UnseenEvent> unseen_event(std::span<const Trial> fitted_runs,
                                        std::span<const std::vector<Vector6d>> fitted,
                                        std::span<const Trial> unseen_runs,
                                        std::span<const std::vector<Vector6d>> unseen) {
  std::optional<UnseenEvent> found;
  Change most{.gain = kEvident};
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const double noise = noise_of(fitted_runs, fitted, axis);
    if (!(noise > 0.0)) continue;
    for (std::size_t r = 0; r < unseen_runs.size(); ++r) {
      const std::vector<Sample> samples = samples_of(unseen_runs[r], unseen[r], axis);
      if (samples.size() < kFewest) continue;
      const Change change = largest_change(samples, noise);
      if (change.gain <= most.gain) continue;
      most = change;
      found = {unseen_runs[r].name, change.t};
    }
  }
  return found;
}

std::optional<UnseenEvent> unseen_event(const model::Model& model, std::span<const Trial> fitted,
                                        std::span<const Trial> unseen) {
  std::vector<std::vector<Vector6d>> of_fitted, of_unseen;
  for (const Trial& run : fitted) of_fitted.push_back(wrench_residuals(model, run));
  for (const Trial& run : unseen) of_unseen.push_back(wrench_residuals(model, run));
  return unseen_event(fitted, of_fitted, unseen, of_unseen);
}

}  // namespace fathom::residual
