// Algorithm 1 of Karras et al. for one axis: periodic inputs, small steps, large steps in turn, with random draws.
// Corrected: the cosine is evaluated at every step (as printed only when a new draw is made, which gives a constant),
// its argument is 2 pi f t, and the phase goes on when the frequency changes.
#pragma once

#include "common/excitation/random.hpp"

namespace fathom::excitation {

struct PaperSignalSettings {
  double largest{};              ///< N or N m: amplitude of periodic inputs and bound of large steps
  double low_share{0.4};         ///< of `largest`: bound of small steps, above it begin the large ones
  double highest_frequency{};    ///< Hz
  int submode_steps{};           ///< SMcounterMax
  int interval_steps{};          ///< INTcounterMax: between draws
  bool random_amplitude{false};  ///< of periodic inputs: true as the text has it, false as the algorithm has it
};

class PaperSignal {
 public:
  PaperSignal(const PaperSignalSettings& settings, std::uint64_t seed);

  /// The input of the next step of `dt` [s].
  double step(double dt);
  /// What pushes one way shall push the other way from now on.
  void turn();
  /// 0 periodic, 1 small steps, 2 large steps.
  [[nodiscard]] int submode() const { return submode_; }

 private:
  void draw();

  PaperSignalSettings settings_;
  Random random_;
  int submode_{0}, submode_count_{0}, interval_count_;
  double amplitude_{}, frequency_{}, phase_{};
};

}  // namespace fathom::excitation
