// Stepwise regression b = A x: forward selection and elimination by F-tests on residuals whitened by a first-order
// autoregressive process (Pereira and Duncan, sec. VI). What is still correlated after whitening is counted from blocks
// of the trial, so that the test knows how many independent samples there are.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/identification/regression/autoregression.hpp"

namespace fathom::identification {

struct StepwiseSettings {
  double familywise{0.05};       ///< probability that any term is selected when none acts; shared among the candidates
  double leave_factor{2.0};      ///< a term leaves when its p-value exceeds this times that of entry
  bool autoregressive{true};     ///< false: phi = 0, plain least squares
  bool effective_samples{true};  ///< false: every sample counts as independent of the others
  double collinear{1e-8};        ///< share of a candidate's square that the selected ones must leave over
  int most{20};                  ///< terms at most
  /// Thresholds on F itself, as stepwise regressions are often given; they take the place of `familywise` and
  /// `leave_factor`. Both or none, and f_out <= f_in.
  std::optional<double> f_in{}, f_out{};
};

struct SelectedTerm {
  int column{};
  double value{};
  double sigma{};  ///< standard error, widened where blocks scatter more than white residuals would
  double f{};      ///< of leaving it out
  double p{};      ///< probability of such an F by chance
  /// What is not in the residual's scatter (term_errors.hpp); zero where nobody has looked.
  double unseen{};                 ///< instruments that are off all the time, and terms that act and were not selected
  std::vector<int> equivalents{};  ///< columns that would explain as much in its place
  [[nodiscard]] double total() const { return std::hypot(sigma, unseen); }
  /// Whether the value is more than its errors together, at 95 %: else an instrument may be all of it.
  [[nodiscard]] bool beyond_errors() const { return std::abs(value) > 1.96 * total(); }
  /// What may be said to act: beyond its errors, and nothing else would explain as much.
  [[nodiscard]] bool stands() const { return beyond_errors() && equivalents.empty(); }
  /// Standard error as Pereira and Duncan print it.
  [[nodiscard]] double percent() const { return value != 0.0 ? 100.0 * total() / std::abs(value) : 0.0; }
};

struct RefusedColumn {
  int column{};
  std::string why;  ///< "zero throughout", "constant throughout", "collinear with NAME"
};

struct StepwiseResult {
  std::vector<SelectedTerm> terms;  ///< in the order of the columns
  int most_significant{-1};         ///< index into terms; -1: none
  std::vector<RefusedColumn> refused;
  double phi{}, phi_sigma{};
  double sigma{};  ///< of the white part e
  int samples{};
  double effective_samples{};  ///< independent ones, after whitening
  double explained{};          ///< share of b's square that the terms explain, unwhitened
  double cross_validated{};    ///< share of whitened b's square predicted where it was not fitted; negative: harmful
};

/// `names` has one name per column of A. `parts` are what cross-validation leaves out in turn (manoeuvres, or pieces of
/// one); their sum is fitted.
[[nodiscard]] StepwiseResult stepwise(const std::vector<LaggedGram>& parts, const std::vector<std::string>& names,
                                      const StepwiseSettings& settings);

}  // namespace fathom::identification
