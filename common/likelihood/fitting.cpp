#include "common/likelihood/fitting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/likelihood/noise_fit.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
constexpr int kTrials = 6;           // of damping, for one step
constexpr double kMostFactor = 2.0;  // of an inertia, in one step
// Of the multi-horizon score: an error of a window is known to a tenth where there are fifty; more tell little more.
constexpr double kEnoughWindows = 50.0;
constexpr int kMostPhases = 3;
constexpr double kTailGain = 10.0;  // nats that a tail must be worth over the Gaussian: it costs what it cannot know

double noise_density(const Problem& problem, const Noise& noise) {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(problem.simulated); ++i)
    sum += problem.noise_prior[i].log_density(noise[i].log);
  return sum;
}

Eigen::MatrixXd with_prior(const std::vector<Number>& numbers, const Eigen::VectorXd& values,
                           Eigen::MatrixXd information) {
  for (std::size_t j = 0; j < numbers.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    information(i, i) += prior_weight(numbers[j], values[i]);
  }
  return information;
}

}  // namespace

Fitting::Fitting(const Problem& problem, Hypothesis start, Noise noise, const FitOptions& options)
    : problem_{&problem},
      options_{options},
      hypothesis_{std::move(start)},
      noise_{std::move(noise)},
      numbers_{problem.numbers(hypothesis_)} {
  clamp(hypothesis_);
  now_ = look(hypothesis_, noise_);
  objective_ = objective(now_, hypothesis_, noise_);
  if (options_.choose_tail) choose_tails();
}

double Fitting::round() {
  const double before = objective_;
  move_numbers();
  if (options_.fit_noise && !options_.horizon) moved_noise_ = move_noise();
  // A fit that waits for its next round is small.
  now_.reduced.clear();
  return objective_ - before;
}

void Fitting::settle() { move_numbers(); }

void Fitting::run(const std::function<void()>& after_round) {
  for (int round_number = 0; round_number < std::max(1, options_.noise_rounds); ++round_number) {
    const double gained = round();
    if (after_round) after_round();
    if (!moved_noise_ || (gained < options_.round_enough && round_number > 0)) break;
  }
  settle();
}

Fit Fitting::fit() const {
  Fit fit{.hypothesis = hypothesis_, .noise = noise_, .numbers = numbers_};
  fit.log_likelihood = now_.log_likelihood;
  fit.scored = now_.scored;
  fit.finite = now_.finite;
  const Eigen::VectorXd x = values(hypothesis_, numbers_);
  fit.information = with_prior(numbers_, x, now_.information);
  fit.log_posterior = objective_;
  fit.log_evidence = fit.finite
                         ? laplace(numbers_, x, now_.log_likelihood, fit.information) + noise_density(*problem_, noise_)
                         : kNever;
  return fit;
}

PassResult Fitting::look(const Hypothesis& hypothesis, const Noise& noise) const {
  PassOptions options{
      .derivatives = true, .reduced = options_.fit_noise || options_.choose_tail, .threads = options_.threads};
  if (!options_.horizon) return pass(*problem_, hypothesis, numbers_, noise, options);
  // Windows begin a part of a cycle later each time: where they are few, every stretch is hidden about twice.
  PassResult sum;
  const double cycle = options_.horizon->lead + options_.horizon->hidden;
  double length = 0.0;
  for (const RunData& run : problem_->runs) length += run.last_time() - run.first_time();
  const int phases = std::clamp(static_cast<int>(std::ceil(kEnoughWindows * cycle / length)), 1, kMostPhases);
  for (int phase = 0; phase < phases; ++phase) {
    options.horizon = options_.horizon;
    options.horizon->phase = cycle * phase / phases;
    PassResult part = pass(*problem_, hypothesis, numbers_, noise, options);
    if (phase == 0) {
      sum = std::move(part);
      continue;
    }
    sum.log_likelihood += part.log_likelihood;
    sum.scored += part.scored;
    sum.finite = sum.finite && part.finite;
    sum.information += part.information;
    sum.gradient += part.gradient;
  }
  return sum;
}

double Fitting::objective(const PassResult& result, const Hypothesis& hypothesis, const Noise& noise) const {
  if (!result.finite) return kNever;
  return result.log_likelihood + log_prior(numbers_, values(hypothesis, numbers_)) + noise_density(*problem_, noise);
}

void Fitting::clamp(Hypothesis& hypothesis) const {
  for (const Number& number : numbers_) {
    double& x = at(hypothesis, number);
    x = std::clamp(x, number.low, number.high);
  }
}

void Fitting::move_numbers() {
  for (int step = 0; step < options_.steps; ++step) {
    if (!now_.finite) return;
    const double gained = step_numbers();
    if (gained < options_.enough) return;
  }
}

/// The Newton step that ends within the limits: what would leave them first stops there, all others move with that
/// known, and so on. A number on its limit is held only if the step of all together would take it out: to clip a step
/// afterwards, or to hold what its own slope alone pushes outwards, stops short where numbers do each other's work
/// (linear drag at zero beside drag of third order).
Eigen::VectorXd Fitting::step_within(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                     const Eigen::VectorXd& x) const {
  Eigen::MatrixXd free = A;
  Eigen::VectorXd right = b;
  std::vector<bool> held(numbers_.size(), false);
  while (true) {
    const Eigen::VectorXd step = solve_symmetric(free, right);
    double least = 1.0;  // of the step, where the first limit is reached
    Eigen::Index first = -1;
    double room_of_first = 0.0;
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const auto j = static_cast<Eigen::Index>(k);
      const Number& number = numbers_[k];
      double low = number.low, high = number.high;
      if (low > 0.0) {  // an inertia near zero makes all else look right: not in one step
        low = std::max(low, x[j] / kMostFactor);
        high = std::min(high, x[j] * kMostFactor);
      }
      const double room = step[j] < 0.0 ? low - x[j] : high - x[j];
      if (held[k] || std::abs(step[j]) <= std::abs(room) || !(std::abs(room / step[j]) < least)) continue;
      least = std::abs(room / step[j]);
      first = j;
      room_of_first = room;
    }
    if (first < 0) return step;
    held[static_cast<std::size_t>(first)] = true;
    right -= room_of_first * free.col(first);
    free.row(first).setZero();
    free.col(first).setZero();
    free(first, first) = 1.0;
    right[first] = room_of_first;
  }
}

/// Gradient of the objective, by the numbers.
Eigen::VectorXd Fitting::slope(const Eigen::VectorXd& x) const {
  Eigen::VectorXd b = now_.gradient;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const Number& number = numbers_[static_cast<std::size_t>(j)];
    b[j] -= (x[j] - number.mean) * prior_weight(number, x[j]);
  }
  return b;
}

/// What the step gained; zero when none did.
double Fitting::step_numbers() {
  const Eigen::VectorXd x = values(hypothesis_, numbers_);
  const Eigen::MatrixXd information = with_prior(numbers_, x, now_.information);
  Eigen::MatrixXd A = curvature_.corrected(information).value_or(information);
  const Eigen::VectorXd b = slope(x);
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::MatrixXd damped = A;
    damped.diagonal() *= 1.0 + damping_;
    const Eigen::VectorXd step = step_within(damped, b, x);
    const double promised = step.dot(b) - 0.5 * step.dot(damped * step);
    if (promised < 0.1 * options_.enough) return 0.0;
    Hypothesis moved = hypothesis_;
    set_values(moved, numbers_, x + step);
    clamp(moved);
    PassResult there = look(moved, noise_);
    const double value = objective(there, moved, noise_);
    if (value > objective_) {
      const double gained = value - objective_;
      hypothesis_ = std::move(moved);
      now_ = std::move(there);
      objective_ = value;
      damping_ = damping_ > 1e-6 ? 0.1 * damping_ : 0.0;
      const Eigen::VectorXd at = values(hypothesis_, numbers_);
      curvature_.learn(with_prior(numbers_, at, now_.information), at - x, b - slope(at));
      return gained;
    }
    if (A != information) {
      A = information;
      curvature_.forget();
      continue;
    }
    damping_ = std::max(10.0 * damping_, 1e-2);
  }
  return 0.0;
}

std::vector<const std::vector<ReducedBlock>*> Fitting::blocks_of(std::size_t axis) const {
  std::vector<const std::vector<ReducedBlock>*> runs;
  for (const auto& run : now_.reduced) runs.push_back(&run[axis]);
  return runs;
}

Noise Fitting::refitted(double& promised) const {
  Noise found = noise_;
  std::vector<double> gained(noise_.size(), 0.0);
  for_each_index(static_cast<std::size_t>(problem_->simulated), options_.threads, [&](std::size_t axis) {
    const NoiseFit fit = fit_noise(blocks_of(axis), noise_[axis], problem_->noise_prior[axis]);
    found[axis] = fit.noise;
    gained[axis] = fit.gained;
  });
  promised = 0.0;
  for (const double gain : gained) promised += gain;
  return found;
}

bool Fitting::move_noise() {
  if (!now_.finite) return false;
  if (now_.reduced.empty()) now_ = look(hypothesis_, noise_);
  double promised = 0.0;
  const Noise found = refitted(promised);
  if (promised < options_.enough) return false;
  for (const double part : {1.0, 0.5, 0.2}) {
    Noise moved = noise_;
    for (std::size_t i = 0; i < moved.size(); ++i)
      for (std::size_t j = 0; j < kNoiseNumbers; ++j) moved[i].log[j] += part * (found[i].log[j] - moved[i].log[j]);
    PassResult there = look(hypothesis_, moved);
    const double value = objective(there, hypothesis_, moved);
    if (value <= objective_) continue;
    noise_ = std::move(moved);
    now_ = std::move(there);
    objective_ = value;
    return true;
  }
  return false;
}

/// Each kind of tail with noise numbers of its own, by the linearised filter.
void Fitting::choose_tails() {
  if (!now_.finite) return;
  move_noise();
  Noise chosen = noise_;
  for_each_index(static_cast<std::size_t>(problem_->simulated), options_.threads, [&](std::size_t axis) {
    const auto blocks = blocks_of(axis);
    double best = kNever;
    for (const Tail tail :
         {Tail{}, Tail{0.0, true}, Tail{8.0, false}, Tail{8.0, true}, Tail{4.0, false}, Tail{4.0, true}}) {
      const Terms& terms = problem_->run_settings.terms;
      if ((tail.freedom > 0.0 && !terms.tails) || (tail.follows && !terms.followed_scale)) continue;
      AxisNoise start = noise_[axis];
      start.tail = tail;
      const AxisNoise fitted = fit_noise(blocks, start, problem_->noise_prior[axis]).noise;
      const double value = reduced_log_likelihood(blocks, fitted) +
                           problem_->noise_prior[axis].log_density(fitted.log) - (tail == Tail{} ? 0.0 : kTailGain);
      if (!(value > best)) continue;
      best = value;
      chosen[axis] = fitted;
    }
  });
  noise_ = std::move(chosen);
  now_ = look(hypothesis_, noise_);
  objective_ = objective(now_, hypothesis_, noise_);
}

}  // namespace fathom::likelihood
