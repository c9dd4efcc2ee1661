// A hypothesis in the middle of its fit: it goes on round by round, so that several can be raced.
#pragma once

#include <functional>

#include "common/likelihood/curvature.hpp"
#include "common/likelihood/fit.hpp"

namespace fathom::likelihood {

class Fitting {
 public:
  /// The problem must outlive it. Looks once, and chooses tails where the options ask for it.
  Fitting(const Problem& problem, Hypothesis start, Noise noise, const FitOptions& options);
  /// Steps of the numbers, then one of the noise; what they gained, in nats of the posterior.
  double round();
  /// Steps of the numbers alone: what the last step of the noise has left open.
  void settle();
  /// Rounds until one gains too little, or as many as the options have, and what they leave open.
  void run(const std::function<void()>& after_round = {});
  /// From now on so many runs of the problem are looked at side by side; no number depends on it.
  void use_threads(int threads) { options_.threads = threads; }
  [[nodiscard]] Fit fit() const;

 private:
  [[nodiscard]] PassResult look(const Hypothesis& hypothesis, const Noise& noise) const;
  [[nodiscard]] double objective(const PassResult& result, const Hypothesis& hypothesis, const Noise& noise) const;
  void clamp(Hypothesis& hypothesis) const;
  void move_numbers();
  /// The Newton step by A and the slope b that ends within the limits of the numbers x.
  [[nodiscard]] Eigen::VectorXd step_within(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                            const Eigen::VectorXd& x) const;
  /// Gradient of the objective, by the numbers x.
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& x) const;
  /// What the step gained; zero when none did.
  double step_numbers();
  [[nodiscard]] std::vector<const std::vector<ReducedBlock>*> blocks_of(std::size_t axis) const;
  [[nodiscard]] Noise refitted(double& promised) const;
  bool move_noise();
  /// Each kind of tail with noise numbers of its own, by the linearised filter.
  void choose_tails();

  const Problem* problem_;
  FitOptions options_;
  Hypothesis hypothesis_;
  Noise noise_;
  std::vector<Number> numbers_;
  PassResult now_;
  double objective_{};
  double damping_{0.0};
  bool moved_noise_{false};
  Curvature curvature_;
};

}  // namespace fathom::likelihood
