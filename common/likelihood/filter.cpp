#include "common/likelihood/filter.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.hpp"
#include "common/base/statistics.hpp"
#include "common/likelihood/filter_run.hpp"

namespace fathom::likelihood {
namespace {

// Priors of the noise, about what the recording's own accelerations and sensors show.
constexpr double kForceOfMotion = 0.1;  // random acceleration over that of the motion
constexpr double kWhiteOfMotion = 0.01;
constexpr double kColourOfSensor = 0.3;  // coloured over white sensor noise
constexpr double kLongestMemory = 30.0;  // s: what stays longer is no noise
constexpr double kLongestColour = 1.0;   // s: unbounded it takes motion
constexpr double kSmallest = 1e-6;

/// Standard deviation of the acceleration over a quarter of a second or so, and of the sensor's white noise.
struct Shown {
  double acceleration{}, sensor{};
};

Shown shown_by(const std::vector<RunData>& runs, int axis, double stated) {
  double square = 0.0, count = 0.0;
  std::vector<double> sensors;
  for (const RunData& run : runs) {
    const Trial& trial = run.trial();
    const auto step = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kAccelerationSpan / trial.dt)));
    std::vector<double> series;
    for (std::size_t k = 0; k < trial.size(); ++k) {
      if (!run.used(k, static_cast<std::size_t>(axis))) continue;
      series.push_back(trial.nu[k][axis]);
      if (k < step || !run.used(k - step, static_cast<std::size_t>(axis))) continue;
      const double rate = (trial.nu[k][axis] - trial.nu[k - step][axis]) / (static_cast<double>(step) * trial.dt);
      square += rate * rate;
      count += 1.0;
    }
    if (series.size() > 10) sensors.push_back(white_noise_sigma(series));
  }
  const double sensor = sensors.empty() ? stated : median(sensors);
  return {std::max(count > 0.0 ? std::sqrt(square / count) : 0.0, kSmallest),
          std::max({sensor, 0.1 * stated, 10.0 * kSmallest})};
}

NoisePrior prior_of(const Shown& shown, double block) {
  NoisePrior prior;
  const auto set = [&](NoiseNumber number, double mean, double sigma, double low, double high) {
    prior.mean[number] = std::log(mean);
    prior.sigma[number] = sigma;
    prior.low[number] = std::log(low);
    prior.high[number] = std::log(high);
  };
  const double a = shown.acceleration, m = shown.sensor;
  set(kForce, kForceOfMotion * a, 2.0, 1e-4 * a, 10.0 * a);
  set(kForceMemory, 0.8, 1.0, 1.5 * block, kLongestMemory);
  set(kWhiteForce, kWhiteOfMotion * a, 1.5, 1e-5 * a, 3.0 * a);
  set(kSensor, m, 0.7, 0.05 * m, 20.0 * m);
  set(kColoured, kColourOfSensor * m, 1.5, 1e-3 * m, 20.0 * m);
  set(kColourMemory, 0.1, 0.7, 0.5 * block, kLongestColour);
  return prior;
}

/// A size of noise that is next to nothing and stays so.
void take_out(NoiseNumber size, NoisePrior& prior) { prior.mean[size] = prior.high[size] = prior.low[size]; }

}  // namespace

Problem make_problem(const model::Vehicle& vehicle, std::span<const Trial> trials, const RunSettings& settings) {
  Problem problem{.vehicle = &vehicle};
  problem.run_settings = settings;
  problem.number_settings.command_offset = settings.terms.command_clock;
  for (int i = 0; i < 6; ++i) {
    if (vehicle.dof[static_cast<std::size_t>(i)]) problem.axes.push_back(i);
  }
  problem.simulated = static_cast<int>(problem.axes.size());
  const std::size_t filled = problem.axes.size() > 4 ? 6 : 4;
  for (int i = 0; i < 6 && problem.axes.size() < filled; ++i) {
    if (!vehicle.dof[static_cast<std::size_t>(i)]) problem.axes.push_back(i);
  }
  bool first = true;
  for (const Trial& trial : trials) {
    if (trial.size() < 2) continue;
    problem.runs.emplace_back(trial, vehicle, settings);
    problem.input_step = std::max(problem.input_step, trial.input_step);
    problem.t_low = first ? trial.t.front() : std::min(problem.t_low, trial.t.front());
    problem.t_high = first ? trial.t.back() : std::max(problem.t_high, trial.t.back());
    first = false;
  }
  if (problem.runs.empty()) return problem;
  const double block = problem.runs.front().blocks().empty() ? 0.1 : problem.runs.front().blocks().front().dt;
  for (const int axis : problem.axes) {
    const Shown shown = shown_by(problem.runs, axis, problem.runs.front().trial().nu_sigma[axis]);
    NoisePrior& prior = problem.noise_prior.emplace_back(prior_of(shown, block));
    if (!settings.terms.random_force) take_out(kForce, prior);
    if (!settings.terms.coloured_noise) take_out(kColoured, prior);
    problem.acceleration.push_back(shown.acceleration);
  }
  return problem;
}

Hypothesis nominal_hypothesis(const Problem& problem) {
  const bool wrench = !problem.runs.empty() && problem.runs.front().trial().input_is_wrench;
  Hypothesis hypothesis{.model = model::nominal_model(*problem.vehicle, wrench)};
  hypothesis.runs.resize(problem.runs.size());
  return hypothesis;
}

Noise prior_noise(const Problem& problem) {
  Noise noise;
  for (const NoisePrior& prior : problem.noise_prior) noise.push_back({.log = prior.mean});
  return noise;
}

PassResult pass(const Problem& problem, const Hypothesis& hypothesis, const std::vector<Number>& numbers,
                const Noise& noise, const PassOptions& options, Reference* reference) {
  const auto run = problem.axes.size() == 4 ? run_of_four : run_of_six;
  if (reference != nullptr) reference->assign(problem.runs.size(), {});
  std::vector<PassResult> results(problem.runs.size());
  for_each_index(problem.runs.size(), options.threads, [&](std::size_t r) {
    results[r] =
        run(problem, hypothesis, numbers, noise, r, options, reference != nullptr ? &(*reference)[r] : nullptr);
  });
  PassResult sum;
  const auto p = static_cast<Eigen::Index>(options.derivatives ? numbers.size() : 0);
  sum.information.setZero(p, p);
  sum.gradient.setZero(p);
  for (PassResult& result : results) {
    sum.log_likelihood += result.log_likelihood;
    sum.scored += result.scored;
    sum.finite = sum.finite && result.finite;
    sum.information += result.information;
    sum.gradient += result.gradient;
    if (options.per_run) sum.per_run.push_back({result.information, result.gradient});
    if (options.reduced) sum.reduced.push_back(std::move(result.reduced.front()));
  }
  sum.finite = sum.finite && std::isfinite(sum.log_likelihood);
  return sum;
}

}  // namespace fathom::likelihood
