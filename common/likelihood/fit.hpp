// A hypothesis fitted: Gauss-Newton on its numbers in turn with the noise numbers, and its evidence by Laplace's
// method.
#pragma once

#include "common/likelihood/filter.hpp"

namespace fathom::likelihood {

struct FitOptions {
  int noise_rounds{3};
  int steps{4};              ///< of Gauss-Newton between two fits of the noise
  double enough{0.05};       ///< nats: a step that gains less is the last one of its round
  double round_enough{1.0};  ///< nats: a round that gains less is the last one
  bool fit_noise{true};
  bool choose_tail{false};  ///< Gaussian or Student's t, of constant or followed scale: by likelihood, per axis
  std::optional<Horizon> horizon{};  ///< numbers by the multi-horizon score, noise as it is
  int threads{1};
};

struct Fit {
  Hypothesis hypothesis;
  Noise noise;
  std::vector<Number> numbers;
  double log_likelihood{};
  double log_posterior{};  ///< with the priors of numbers and noise
  double log_evidence{};
  bool finite{false};
  double scored{};
  Eigen::MatrixXd information;                  ///< of the numbers, prior included
  [[nodiscard]] Eigen::VectorXd sigma() const;  ///< of the numbers, if the model is right
};

[[nodiscard]] Fit fit(const Problem& problem, Hypothesis start, Noise noise, const FitOptions& options);

/// The same numbers seen once more, nothing fitted: with what the scan needs.
void refer(const Problem& problem, Fit& fit, Reference& reference, int threads);

/// log N(theta; prior) + log L + p/2 log 2 pi - 1/2 log det(information): MacKay 2003, ch. 27.
[[nodiscard]] double laplace(const std::vector<Number>& numbers, const Eigen::VectorXd& values, double log_likelihood,
                             const Eigen::MatrixXd& information_with_prior);

}  // namespace fathom::likelihood
