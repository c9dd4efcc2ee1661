// One file: a dive with the pilot in the loop, and what the instruments would show without noise and with it.
#pragma once

#include "test/sealed/craft/body.hpp"

namespace fathom::sealed {

/// Noise of the instruments, standard deviation per sample.
struct Noise {
  double position{0.005}, velocity{0.005};                                             // m, m/s
  double angle{0.2 * std::numbers::pi / 180.0}, rate{0.2 * std::numbers::pi / 180.0};  // rad, rad/s
};

struct Dive {
  double begin{}, dt{0.01};     ///< s, time of the first sample on the file's clock
  Commands commands;            ///< from the warm-up on
  std::vector<State> state;     ///< truth, at the samples
  std::vector<Vector6> nu_dot;  ///< truth
  Streams sensed;               ///< noise-free, as the instruments understand it
  std::vector<Vector6> pose_noise, nu_noise;
  std::vector<double> voltage;  ///< V; empty when nobody measures it
  [[nodiscard]] std::size_t size() const { return state.size(); }
  [[nodiscard]] const Eigen::VectorXd& command(std::size_t sample) const { return commands.force[warm_up + sample]; }
  std::size_t warm_up{};  ///< samples before the first that is kept
  bool sound{true};       ///< false: it ran away, and was stopped
};

struct DiveOrder {
  double begin{}, length{330.0};  ///< s
  std::uint64_t seed{};           ///< of excitation, noise and random paths
  std::string purpose;            ///< which file of the set
  Hold hold{Hold::kLine};
};

/// `mechanisms` are told that a file begins.
[[nodiscard]] Dive dive(const Craft& craft, const Site& site, const Mechanisms& mechanisms, const Noise& noise,
                        const DiveOrder& order);

}  // namespace fathom::sealed
