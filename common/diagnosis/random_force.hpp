// A random force with a memory (turbulence, a swinging tether) that a pilot or an autopilot answers leaves traces in
// place, speed and thrust, and effects that go with these seem to explain it: a fit to trajectories holds every sample
// of such a force for unforeseen. Here the force's own past foretells it (prediction errors of an autoregression, which
// feedback does not bend: Ljung, System Identification, 1999, ch. 13.4), and an effect counts for what it adds to that.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/trial.hpp"

namespace fathom::diagnosis {

class RandomForce {
 public:
  /// By the forces that `reference` leaves in these runs (force_residual.hpp), as accelerations: measured ones are what
  /// is foretold, and a mass that is too small must not make them small. What it is made from must outlive it.
  RandomForce(const model::Model& reference, std::span<const Trial> trials);

  /// Natural log-likelihood ratios over the reference with forces that come and go unforeseen.
  struct Answer {
    double effect{};    ///< of the effect
    double memory{};    ///< of a memory, whose numbers are paid for (BIC)
    double both{};      ///< of the effect beside such a memory
    double expected{};  ///< what the effect would add to a memory if it acted as fitted
  };
  /// Of the one effect that `model` has beyond the reference. Base numbers and the effect's are those, to first order,
  /// that leave least.
  [[nodiscard]] Answer ask(const model::Model& model) const;

 private:
  static constexpr Eigen::Index kOrder = 4;  // samples of half a second
  using Memory = Eigen::Matrix<double, kOrder, 1>;
  using Series = std::vector<Eigen::MatrixXd>;  // by run: samples x axes, no two of which share a measurement

  struct Noise {
    std::array<Memory, 6> memory;
    Vector6d weight = Vector6d::Ones();  ///< one over the variance of what is not foretold
  };
  /// Samples of one axis without a gap: what is left, then what every number changes of it.
  struct Stretch {
    Eigen::Index axis{};
    Eigen::MatrixXd rows;
  };
  struct Fit {
    Noise noise;
    double log_likelihood{};
  };

  [[nodiscard]] Series residuals(const model::Model& model) const;
  [[nodiscard]] std::vector<Stretch> stretches(const Series& left, std::span<const Series> changes) const;
  [[nodiscard]] static Eigen::MatrixXd unforetold(const Stretch& stretch, const Noise& noise);
  [[nodiscard]] static Fit fit(std::span<const Stretch> stretches, const Eigen::VectorXd& prior, bool remembers);
  [[nodiscard]] double expected(const Series& left) const;

  const model::Model& reference_;
  std::span<const Trial> trials_;
  Series left_;
  std::vector<Series> changes_;
  Eigen::VectorXd prior_;  ///< information, per number
  Fit plain_, remembering_;
};

}  // namespace fathom::diagnosis
