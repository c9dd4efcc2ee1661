#include "common/likelihood/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

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

/// A hypothesis in the middle of its fit.
class Fitting {
 public:
  Fitting(const Problem& problem, Hypothesis start, Noise noise, const FitOptions& options)
      : problem_{problem}, options_{options}, hypothesis_{std::move(start)}, noise_{std::move(noise)} {
    numbers_ = problem.numbers(hypothesis_);
    clamp(hypothesis_);
    now_ = look(hypothesis_, noise_);
    objective_ = objective(now_, hypothesis_, noise_);
  }

  Fit run() {
    if (options_.choose_tail) choose_tails();
    for (int round = 0; round < std::max(1, options_.noise_rounds); ++round) {
      const double before = objective_;
      move_numbers();
      const bool last = round + 1 >= options_.noise_rounds;
      if (!options_.fit_noise || options_.horizon || !move_noise() ||
          (objective_ - before < options_.round_enough && round > 0)) {
        if (!last) move_numbers();
        break;
      }
      if (last) move_numbers();
    }
    Fit fit{.hypothesis = hypothesis_, .noise = noise_, .numbers = numbers_};
    fit.log_likelihood = now_.log_likelihood;
    fit.scored = now_.scored;
    fit.finite = now_.finite;
    const Eigen::VectorXd x = values(hypothesis_, numbers_);
    fit.information = with_prior(numbers_, x, now_.information);
    fit.log_posterior = objective_;
    fit.log_evidence =
        fit.finite ? laplace(numbers_, x, now_.log_likelihood, fit.information) + noise_density(problem_, noise_)
                   : kNever;
    return fit;
  }

 private:
  PassResult look(const Hypothesis& hypothesis, const Noise& noise) const {
    PassOptions options{
        .derivatives = true, .reduced = options_.fit_noise || options_.choose_tail, .threads = options_.threads};
    if (!options_.horizon) return pass(problem_, hypothesis, numbers_, noise, options);
    // Windows begin a part of a cycle later each time: where they are few, every stretch is hidden about twice.
    PassResult sum;
    const double cycle = options_.horizon->lead + options_.horizon->hidden;
    double length = 0.0;
    for (const RunData& run : problem_.runs) length += run.last_time() - run.first_time();
    const int phases = std::clamp(static_cast<int>(std::ceil(kEnoughWindows * cycle / length)), 1, kMostPhases);
    for (int phase = 0; phase < phases; ++phase) {
      options.horizon = options_.horizon;
      options.horizon->phase = cycle * phase / phases;
      PassResult part = pass(problem_, hypothesis, numbers_, noise, options);
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

  double objective(const PassResult& result, const Hypothesis& hypothesis, const Noise& noise) const {
    if (!result.finite) return kNever;
    return result.log_likelihood + log_prior(numbers_, values(hypothesis, numbers_)) + noise_density(problem_, noise);
  }

  void clamp(Hypothesis& hypothesis) const {
    for (const Number& number : numbers_) {
      double& x = at(hypothesis, number);
      x = std::clamp(x, number.low, number.high);
    }
  }

  void move_numbers() {
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
  [[nodiscard]] Eigen::VectorXd step_within(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                            const Eigen::VectorXd& x) const {
    Eigen::MatrixXd free = A;
    Eigen::VectorXd right = b;
    std::vector<bool> held(numbers_.size(), false);
    while (true) {
      const Eigen::VectorXd step = free.ldlt().solve(right);
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

  /// What the step gained; zero when none did.
  double step_numbers() {
    const Eigen::VectorXd x = values(hypothesis_, numbers_);
    Eigen::MatrixXd A = with_prior(numbers_, x, now_.information);
    Eigen::VectorXd b = now_.gradient;
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const Number& number = numbers_[static_cast<std::size_t>(j)];
      b[j] -= (x[j] - number.mean) * prior_weight(number, x[j]);
    }
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
        return gained;
      }
      damping_ = std::max(10.0 * damping_, 1e-2);
    }
    return 0.0;
  }

  [[nodiscard]] std::vector<const std::vector<ReducedBlock>*> blocks_of(std::size_t axis) const {
    std::vector<const std::vector<ReducedBlock>*> runs;
    for (const auto& run : now_.reduced) runs.push_back(&run[axis]);
    return runs;
  }

  [[nodiscard]] Noise refitted(double& promised) const {
    Noise found = noise_;
    std::vector<double> gained(noise_.size(), 0.0);
    for_each_index(static_cast<std::size_t>(problem_.simulated), options_.threads, [&](std::size_t axis) {
      const NoiseFit fit = fit_noise(blocks_of(axis), noise_[axis], problem_.noise_prior[axis]);
      found[axis] = fit.noise;
      gained[axis] = fit.gained;
    });
    promised = 0.0;
    for (const double gain : gained) promised += gain;
    return found;
  }

  bool move_noise() {
    if (!now_.finite) return false;
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
  void choose_tails() {
    if (!now_.finite) return;
    move_noise();
    Noise chosen = noise_;
    for_each_index(static_cast<std::size_t>(problem_.simulated), options_.threads, [&](std::size_t axis) {
      const auto blocks = blocks_of(axis);
      double best = kNever;
      for (const Tail tail :
           {Tail{}, Tail{0.0, true}, Tail{8.0, false}, Tail{8.0, true}, Tail{4.0, false}, Tail{4.0, true}}) {
        AxisNoise start = noise_[axis];
        start.tail = tail;
        const AxisNoise fitted = fit_noise(blocks, start, problem_.noise_prior[axis]).noise;
        const double value = reduced_log_likelihood(blocks, fitted) +
                             problem_.noise_prior[axis].log_density(fitted.log) - (tail == Tail{} ? 0.0 : kTailGain);
        if (!(value > best)) continue;
        best = value;
        chosen[axis] = fitted;
      }
    });
    noise_ = std::move(chosen);
    now_ = look(hypothesis_, noise_);
    objective_ = objective(now_, hypothesis_, noise_);
  }

  const Problem& problem_;
  const FitOptions& options_;
  Hypothesis hypothesis_;
  Noise noise_;
  std::vector<Number> numbers_;
  PassResult now_;
  double objective_{kNever};
  double damping_{0.0};
};

}  // namespace

Eigen::VectorXd Fit::sigma() const {
  const Eigen::Index p = information.rows();
  const Eigen::MatrixXd covariance = information.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

double laplace(const std::vector<Number>& numbers, const Eigen::VectorXd& values, double log_likelihood,
               const Eigen::MatrixXd& information_with_prior) {
  // Scaled by the priors, so that the determinant neither over- nor underflows.
  const auto p = static_cast<Eigen::Index>(numbers.size());
  Eigen::VectorXd sigma(p);
  for (Eigen::Index j = 0; j < p; ++j) sigma[j] = numbers[static_cast<std::size_t>(j)].sigma;
  const Eigen::LDLT<Eigen::MatrixXd> ldlt{sigma.asDiagonal() * information_with_prior * sigma.asDiagonal()};
  double log_det = 0.0;
  for (Eigen::Index j = 0; j < p; ++j) log_det += std::log(std::max(ldlt.vectorD()[j], 1e-300));
  log_det -= 2.0 * sigma.array().log().sum();
  return log_likelihood + log_prior(numbers, values) + 0.5 * static_cast<double>(p) * std::log(2.0 * std::numbers::pi) -
         0.5 * log_det;
}

Fit fit(const Problem& problem, Hypothesis start, Noise noise, const FitOptions& options) {
  return Fitting{problem, std::move(start), std::move(noise), options}.run();
}

void refer(const Problem& problem, Fit& fit, Reference& reference, int threads) {
  const PassResult seen = pass(problem, fit.hypothesis, fit.numbers, fit.noise, {.threads = threads}, &reference);
  fit.log_likelihood = seen.log_likelihood;
  fit.information = with_prior(fit.numbers, values(fit.hypothesis, fit.numbers), seen.information);
}

}  // namespace fathom::likelihood
