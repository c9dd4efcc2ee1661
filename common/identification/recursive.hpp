// Constrained recursive least squares in factored form: P = U D U', rows one by one (Bierman 1977), so that rounding
// stays harmless over hours. Constraints act on the reported estimate alone and are never fed back.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/identification/projection.hpp"
#include "common/identification/rows.hpp"

namespace fathom::identification {

struct RecursiveSettings {
  ParameterVector mean;    ///< prior
  ParameterVector sigma;   ///< prior standard deviation, > 0
  Signs signs{};           ///< constraints on the report
  double forgetting{1.0};  ///< weight that a step leaves to everything before it, (0, 1]
  ParameterVector cap;     ///< sigma beyond which forgetting does not let a parameter grow; empty: the prior's
};

/// What is left on one axis: the innovation, scaled so that its variance is the row's when the model is right.
struct AxisStatistics {
  double weight{};      ///< effective number of residuals
  double mean{};        ///< N, N m
  double variance{};    ///< about the mean
  double covariance{};  ///< of one step with the next
  double last{};
  /// Autocorrelation from one step to the next.
  [[nodiscard]] double lag1() const { return variance > 0.0 ? covariance / variance : 0.0; }
};

struct RecursiveReport {
  ParameterVector estimate;                   ///< nearest admissible point
  ParameterVector sigma;                      ///< honest: widened for coloured and larger residuals
  ParameterMatrix covariance;                 ///< honest, unconstrained
  ParameterVector inflation;                  ///< per parameter: honest over nominal variance
  std::array<bool, kMaxParameters> active{};  ///< held at zero by its sign
};

class RecursiveEstimator {
 public:
  /// Steps over which scores are summed to see how they hang together: two of the identifier's windows. Windows that
  /// overlap share their noise, and an error of the velocity between two has one sign in the first and the other in the
  /// second.
  static constexpr int kTogether = 8;

  /// Everything that step() changes: copy it to save, hand it back to resume. Vectors, and the rows of U, are rounded
  /// up to packets by zeros (bierman.hpp).
  struct State {
    ParameterVector estimate;  ///< unconstrained
    ParameterMatrix U;         ///< unit upper triangular
    ParameterVector D;
    std::array<bool, kMaxParameters> frozen{};
    std::int64_t updates{};  ///< rows used
    std::array<AxisStatistics, 6> axes{};
    ParameterVector information;  ///< sum of h^2 / variance
    ParameterVector derivatives;  ///< sum of 1 / variance over the rows that taught it as their derivative
    double steps{};               ///< effective number of them
    ParameterVector score0;       ///< sum of the squared score, score = sum over rows of h * residual / variance
    ParameterVector fourth;       ///< sum of the score's fourth power: how many scores these sums are made of
    ParameterVector together;     ///< sum of the squares of what kTogether successive scores add up to
    ParameterVector apart;        ///< sum of its products with what as many scores before it add up to
    ParameterMatrix last_scores;  ///< of the last kTogether steps, a column each, written round and round
    ParameterMatrix last_sums;    ///< likewise
    int oldest{};                 ///< of the columns
    double steps_until_check{};
  };

  /// InputError when sizes disagree or a sigma or the forgetting factor is out of range.
  explicit RecursiveEstimator(RecursiveSettings settings);

  /// Forgets once, then takes the rows (of one instant) in. Allocates nothing.
  void step(std::span<const Row> rows);

  /// Frozen parameters keep value and variance, but their doubt still widens that of the others (Schmidt 1966).
  void freeze(int parameter);
  void resume(int parameter);

  /// Estimate moved to the nearest admissible point.
  [[nodiscard]] ParameterVector projected() const;
  [[nodiscard]] RecursiveReport report() const;

  [[nodiscard]] int size() const { return static_cast<int>(settings_.mean.size()); }
  [[nodiscard]] const Signs& signs() const { return settings_.signs; }
  [[nodiscard]] const ParameterVector& prior_sigma() const { return settings_.sigma; }
  [[nodiscard]] ParameterVector unconstrained() const { return state_.estimate.head(size()); }
  [[nodiscard]] ParameterMatrix covariance() const;  ///< nominal: trusts the stated variances
  [[nodiscard]] const State& state() const { return state_; }
  /// InputError when the state is of another size, not finite, or its covariance not positive.
  void restore(const State& state);
  /// Back to the prior.
  void reset();

 private:
  void count_frozen();
  void forget();
  void take(const Row& row);
  void add_outer(double factor, ParameterVector& v);
  [[nodiscard]] ParameterVector inflation(const ParameterMatrix& P) const;

  RecursiveSettings settings_;
  State state_;
  ParameterVector sign_;  // of the settings, 0 where free
  bool any_frozen_{};
  ParameterVector free_, score_;  // 1 where not frozen; of the step that is being taken; padded
};

}  // namespace fathom::identification
