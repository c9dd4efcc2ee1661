// What stands against fitting anything to a recording, to be said before somebody tries: commands too rare, a craft
// that never moves, thrusters that never change.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::recordings {

struct WorthThresholds {
  double command_rate{5.0};    ///< Hz: between slower commands the thrust is not known well enough to explain motion
  double least_pulse{500.0};   ///< us: smaller commands are no pulses, but shaft speeds or angles
  double pulse_span{20.0};     ///< us: below, a speed controller stays within its dead band
  double relative_span{0.02};  ///< of the largest force or wrench: below, nothing was commanded
  double rate_spread{0.02};    ///< rad/s, standard deviation: a gyro of a craft at rest scatters less
  double velocity_size{0.02};  ///< m/s, root mean square: as of a velocity log at rest
  double position_span{0.10};  ///< m, as of a position at rest
};

/// Of up to three components: mean, spread and range.
class Spread {
 public:
  void add(const Eigen::Vector3d& value);
  [[nodiscard]] bool any() const { return count_ > 1; }
  [[nodiscard]] double deviation() const;  ///< the largest standard deviation
  [[nodiscard]] double size() const;       ///< the largest root mean square
  [[nodiscard]] double span() const { return (high_ - low_).maxCoeff(); }

 private:
  std::size_t count_{};
  Eigen::Vector3d mean_{Eigen::Vector3d::Zero()}, squares_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d low_{Eigen::Vector3d::Constant(1e300)}, high_{Eigen::Vector3d::Constant(-1e300)};
};

/// Looks at a recording part after part.
class Worth {
 public:
  void take(const Recording& part);
  /// One sentence each; empty when there is nothing to say.
  [[nodiscard]] std::vector<std::string> against_fitting(const WorthThresholds& thresholds = {}) const;

 private:
  /// Least and greatest of each of several numbers.
  struct Ranges {
    std::vector<double> low, high;
    void add(std::span<const double> values);
    [[nodiscard]] double widest() const;
    [[nodiscard]] double largest() const;
    [[nodiscard]] double widest_share() const;  ///< of a number's own size: units may differ
  };
  void thrusters(const WorthThresholds& limits, std::vector<std::string>& found) const;

  Spread rates_, velocity_, position_;
  Ranges pulses_, forces_, wrench_;
  std::vector<Utime> steps_;  ///< between commands, the first of them: for the median
  std::optional<Utime> latest_;
  bool positioned_{};  ///< by something else than motion capture
};

/// The same of a whole recording.
[[nodiscard]] std::vector<std::string> against_fitting(const Recording& recording,
                                                       const WorthThresholds& thresholds = {});

}  // namespace fathom::recordings
