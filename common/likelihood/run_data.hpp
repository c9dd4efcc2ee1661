// One run as the filter reads it: blocks of samples that are predicted as means, and what is given rather than
// predicted (attitude, place, axes that are not simulated, voltage) at the middle of every interval.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/trial.hpp"

namespace fathom::likelihood {

/// Terms of the likelihood beside the model's motion. All of them, but where it is measured what one is good for.
struct Terms {
  bool random_force{true};    ///< with a memory, per axis
  bool coloured_noise{true};  ///< of the sensors
  bool tails{true};           ///< Student's t
  bool followed_scale{true};  ///< of the innovations, as the recording has it
  bool command_clock{true};   ///< off the samples', per run
};

struct RunSettings {
  double block_rate{25.0};     ///< Hz at most; blocks are whole numbers of samples
  double burn_in{2.0};         ///< s that are filtered and not scored: what is remembered from before is unknown
  double burn_in_share{0.1};   ///< of a run at most
  double quickest_share{0.2};  ///< largest step over the quickest time constant: third-order steps then err by 3e-4
  double largest_step{0.05};   ///< s
  Terms terms{};
};

/// Between two samples, at the middle.
struct Interval {
  double t{};  ///< s
  Eigen::Matrix3d R_WB{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};  ///< m
  Vector6d told{Vector6d::Zero()};                ///< measured velocities, used on axes that are not simulated
  Vector6d told_slope{Vector6d::Zero()};          ///< zero on simulated axes
  double voltage{};
  std::span<const double> columns{};  ///< of the trial
};

/// Samples (first, last]: the state is carried from sample `first` to sample `last`.
struct Block {
  std::size_t first{}, last{};
  double dt{};                   ///< s
  bool scored{true};             ///< after the burn-in
  Vector6d y{Vector6d::Zero()};  ///< mean of the samples used
  Vector6d n{Vector6d::Zero()};  ///< how many were used; 0: not measured
  /// What the mean of the samples used shares with the block's end: x is a sample's place in the block, 0 to 1.
  Vector6d lag{Vector6d::Zero()};   ///< 1 - mean of x
  Vector6d walk{Vector6d::Zero()};  ///< variance of the mean of a random walk that begins at 0 and ends with 1
  Vector6d force_end{
      Vector6d::Zero()};  ///< integrated walk: covariance of its mean with its end, mean of x^2/2 - x^3/6
  Vector6d force_walk{Vector6d::Zero()};  ///< with the walk's end, mean of x^2/2
  Vector6d force_mean{Vector6d::Zero()};  ///< variance of its mean
};

class RunData {
 public:
  RunData(const Trial& trial, const model::Vehicle& vehicle, const RunSettings& settings);

  [[nodiscard]] const Trial& trial() const { return *trial_; }
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<Interval>& intervals() const { return intervals_; }
  [[nodiscard]] int substeps() const { return substeps_; }  ///< per interval
  [[nodiscard]] double h() const { return h_; }             ///< s, of a substep
  [[nodiscard]] double dt() const { return trial_->dt; }
  [[nodiscard]] std::size_t block_size() const { return block_size_; }
  [[nodiscard]] const Vector6d& start() const { return start_; }  ///< velocity at the first sample
  [[nodiscard]] double first_time() const { return trial_->t.front(); }
  [[nodiscard]] double last_time() const { return trial_->t.back(); }
  /// Samples that take part, per axis and sample: neither a spike, nor held from the sample before, nor a guess.
  [[nodiscard]] bool used(std::size_t sample, std::size_t axis) const { return used_[sample][axis] != 0; }
  /// Blocks that end within [from, to) s are filtered and not scored: no number is fitted to them.
  void leave_out(double from, double to);
  [[nodiscard]] std::size_t spikes() const { return spikes_; }
  [[nodiscard]] std::size_t held() const { return held_; }

 private:
  const Trial* trial_;
  std::vector<Block> blocks_;
  std::vector<Interval> intervals_;
  std::vector<std::array<std::uint8_t, 6>> used_;
  Vector6d start_{Vector6d::Zero()};
  std::size_t block_size_{1}, spikes_{}, held_{};
  int substeps_{1};
  double h_{};
};

/// Indices of samples that jump out and back again: beyond `limit` standard deviations of what neighbours tell.
[[nodiscard]] std::vector<std::size_t> isolated_spikes(const std::vector<double>& series, double limit = 8.0);

}  // namespace fathom::likelihood
