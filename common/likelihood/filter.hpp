// The likelihood of recordings: a Kalman filter of the random force, the white force and the sensors' noise that runs
// around the model's own nonlinear rollout, so that the density of a run is the product of one-step predictions
// (prediction error method: Ljung 1999, sec. 7.4; Jategaonkar 2015, ch. 5). Predictions use the past alone, so a pilot
// who answers the random force bends nothing. docs/decisions/126 has the equations.
//
//   x = [nu; d; c]   nu' = a(nu, t; theta) + d + white,  d Ornstein-Uhlenbeck,  c first-order sensor noise
//   y = mean over a block of (sensor(nu) + c + white)
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/likelihood/noise_numbers.hpp"
#include "common/likelihood/plant.hpp"

namespace fathom::likelihood {

constexpr double kAccelerationSpan = 0.25;  ///< s

/// What stays the same for everything that is compared.
struct Problem {
  const model::Vehicle* vehicle{};
  std::vector<RunData> runs;
  /// Axes of the filter, 0..5: the simulated ones, filled up with others to four or six, which are never measured.
  std::vector<int> axes;
  int simulated{};  ///< how many of them, the first
  NumberSettings number_settings{};
  RunSettings run_settings{};
  double input_step{}, t_low{}, t_high{};  ///< s
  std::vector<NoisePrior> noise_prior;     ///< per axis
  std::vector<double> acceleration;        ///< per axis, rms of the motion's over kAccelerationSpan

  [[nodiscard]] std::vector<Number> numbers(const Hypothesis& hypothesis) const {
    return numbers_of(hypothesis, number_settings, input_step, t_low, t_high);
  }
};

/// Problem of these trials, which must outlive it, with priors of the noise by what they show.
[[nodiscard]] Problem make_problem(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                   const RunSettings& settings = {});
/// The base model at the vehicle file's numbers, for these runs.
[[nodiscard]] Hypothesis nominal_hypothesis(const Problem& problem);
/// Noise numbers at their priors' means, Gaussian.
[[nodiscard]] Noise prior_noise(const Problem& problem);

/// Measurements are used for `lead` s, then hidden for `hidden` s, in which every one is scored with its own marginal
/// density; and so on. `phase` s earlier than the run's beginning.
struct Horizon {
  double lead{5.0}, hidden{10.0}, phase{0.0};
};

/// One block of one axis as the noise numbers see it: the filter linearised about its own estimates.
struct ReducedBlock {
  double F{1.0}, G{}, r{}, z{};  ///< delta' = F delta + G d + r; z: see noise_fit.cpp
  double lag{}, walk{}, force_end{}, force_walk{}, force_mean{}, n{}, dt{};
  double
      others{};  ///< variance of the velocity that other axes' errors add over the block, as the whole filter knows it
  bool scored{};
};

/// One filtered run, kept so that other accelerations can be asked for their effect (scan).
struct RunReference {
  int axes{}, numbers{};
  static constexpr std::size_t kMatrices = 6;
  std::vector<double> gains;                    ///< per block: E, Gamma, K_nu, K_d, K_c, L^-1, each axes x axes
  Eigen::VectorXd mean_force, rho, rho_colour;  ///< per axis, of a block
  Eigen::MatrixXd innovation;                   ///< axes x blocks, whitened
  Eigen::MatrixXd slope, information;           ///< axes x blocks, of the tail's score; zero where not scored
  Eigen::MatrixXd nu_middle, nu_dot, nu_end;    ///< 6 x blocks: of the rollout, and as filtered
  Eigen::MatrixXd trace;                        ///< 6 x samples, of the rollout
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J;  ///< (axes x blocks) x numbers, whitened
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> B;  ///< the same, accelerations
};
using Reference = std::vector<RunReference>;

struct PassOptions {
  bool derivatives{true};
  bool reduced{false};
  bool per_run{false};
  std::optional<Horizon> horizon{};
  int threads{1};  ///< over runs
};

/// Of one run: without the prior.
struct RunInformation {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

struct PassResult {
  double log_likelihood{};
  double scored{};  ///< numbers
  bool finite{true};
  Eigen::MatrixXd information;                                  ///< of the numbers, without the prior
  Eigen::VectorXd gradient;                                     ///< of the log likelihood
  std::vector<std::vector<std::vector<ReducedBlock>>> reduced;  ///< per run, axis, block
  std::vector<RunInformation> per_run;
};

[[nodiscard]] PassResult pass(const Problem& problem, const Hypothesis& hypothesis, const std::vector<Number>& numbers,
                              const Noise& noise, const PassOptions& options, Reference* reference = nullptr);

}  // namespace fathom::likelihood
