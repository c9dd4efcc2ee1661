// The score test of everything at once: what every candidate, and every pair of the best, promises beside a fitted
// model, from one filtered pass and without a fit.
#pragma once

#include "common/inference/catalogue.hpp"
#include "common/inference/thresholds.hpp"
#include "common/likelihood/fit.hpp"
#include "common/likelihood/response.hpp"

namespace fathom::inference {

/// A fitted model seen so that questions can be asked of it.
struct Seen {
  likelihood::Fit fit;
  likelihood::Reference reference;
  Eigen::MatrixXd covariance;  ///< of the numbers, prior included
  /// That the numbers would take under the seen noise: they move along with what is asked, and nothing is promised for
  /// what they do by themselves. 0 of those that are pressed against a limit.
  Eigen::VectorXd step;
  std::vector<Eigen::MatrixXd> inverse;  ///< per run: inverse inertia of every block, 36 x blocks
  Vector6d applied{Vector6d::Zero()};  ///< rms of the actuators' acceleration, per axis of the body; where none pushes,
                                       ///< of the motion's own
};
[[nodiscard]] Seen see(const likelihood::Problem& problem, likelihood::Fit fit, int threads);

/// What a law promises at its best grid point.
struct Promise {
  std::size_t law{};
  std::vector<double> theta;                ///< where a fit begins: the linear solution
  double gain{};                            ///< nats of likelihood
  double score{};                           ///< with the Occam factor of its linear numbers
  std::vector<std::vector<double>> also{};  ///< other grid points that promise nearly as much: fits begin there too
};
struct PairPromise {
  std::size_t first{}, second{};  ///< of the promises
  double score{};
  std::vector<double> theta_first, theta_second;
};
struct Scan {
  std::vector<Promise> promises;   ///< best first; one per law
  std::vector<PairPromise> pairs;  ///< best first
};

[[nodiscard]] Scan scan(const likelihood::Problem& problem, const Seen& seen, const std::vector<Law>& laws,
                        const Thresholds& thresholds, int threads);

/// Where fits of one law beside a seen model begin: the maxima of its score over its times, frequencies and places, the
/// best `count` that promise enough to be fitted.
[[nodiscard]] std::vector<std::vector<double>> starts_of(const likelihood::Problem& problem, const Seen& seen,
                                                         const Law& law, std::size_t count,
                                                         const Thresholds& thresholds, int threads);
/// Whether its score has more than one place to begin from.
[[nodiscard]] bool shaped(const Law& law);

/// Accelerations that an effect adds to a hypothesis at the seen model's filtered velocities: axes x blocks, `shown`
/// likewise.
class EffectColumns {
 public:
  EffectColumns(const likelihood::Problem& problem, const Seen& seen, const likelihood::Hypothesis& hypothesis,
                std::size_t run);
  /// Columns to come; all must be added before the first block. `theta`: the effect's numbers of the column.
  void add(const model::ActiveEffect& effect, const std::vector<double>& theta);
  [[nodiscard]] std::size_t size() const { return columns_.size(); }
  void at(std::size_t block, likelihood::ColumnsOut acceleration, likelihood::ColumnsOut shown);

 private:
  struct Column {
    model::ActiveEffect effect;
    model::Model model;  // with it, where its stage asks for one
    likelihood::Stage stage{};
    Eigen::MatrixXd thrust;                        ///< change of the mean forces, actuators x blocks
    std::vector<likelihood::MotionMemory> memory;  ///< one at most
    std::vector<likelihood::SensorStage> sensor;
  };
  const likelihood::Problem& problem_;
  const Seen& seen_;
  double command_offset_;
  std::size_t run_;
  std::vector<likelihood::Number> none_;
  likelihood::Plant plant_;
  std::vector<Column> columns_;
};

/// Residual rms of accelerations (axes x blocks per run) after least squares on the base numbers' columns, over the
/// applied acceleration, on the worst axis (returned too).
struct Size {
  double share{};
  int axis{};
  double over{};  ///< the same rms over the random force that the seen model has on that axis
};
[[nodiscard]] Size size_of(const likelihood::Problem& problem, const Seen& seen,
                           const std::vector<Eigen::MatrixXd>& accelerations);
/// Share of the applied acceleration that an effect of the seen model adds, least squares on the base numbers' columns
/// taken out, on its worst axis. An effect on the sensors: of the velocity, on no axis (-1).
[[nodiscard]] Size size_of_effect(const likelihood::Problem& problem, const Seen& seen, std::size_t effect,
                                  int threads = 1);
/// The same of an effect that the seen model does not hold, if it had it.
[[nodiscard]] double size_beside(const likelihood::Problem& problem, const Seen& seen,
                                 const model::ActiveEffect& active);
/// The same of what is missing in the seen model, whose random force has taken its place: on no axis is it larger than
/// that, whatever its parts come to that undo each other.
[[nodiscard]] Size size_of_missing(const likelihood::Problem& problem, const Seen& seen,
                                   const std::vector<Eigen::MatrixXd>& accelerations);

/// What columns gain in the likelihood at the amplitudes that their priors (Student's t of width `sigma`) and the
/// gradient agree on, and the score with its Occam factor.
struct Gain {
  double gain{}, score{};
  Eigen::VectorXd amplitude;
};
[[nodiscard]] Gain linear_gain(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                               const Eigen::VectorXd& sigma);

}  // namespace fathom::inference
