// A printing error of Karras et al. in Algorithm 1: a cos(f t) with f from (0, f_max) in Hz lacks 2 pi, and jumps
// whenever f does. That it is evaluated with a new draw only is another one: paper_signal_test.cpp.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/excitation/paper_signal.hpp"

namespace fathom::excitation {
namespace {

constexpr double kStep = 0.05;  // s
constexpr int kSteps = 4000;    // of one draw: 200 s

/// Periods of a signal, by how often it rises through zero.
class Periods {
 public:
  void see(double value) {
    count_ += value >= 0.0 && last_ < 0.0 ? 1 : 0;
    last_ = value;
  }
  [[nodiscard]] int count() const { return count_; }

 private:
  double last_{};
  int count_{};
};

}  // namespace

TEST_CASE("printed algorithm 1: cos(f t) has f / (2 pi) periods a second, and jumps where f does") {
  const PaperSignalSettings settings{
      .largest = 10.0, .highest_frequency = 0.5, .submode_steps = 1'000'000, .interval_steps = kSteps};
  PaperSignal signal{settings, 7};
  Random random{7};  // the same draws
  double t = 0.0, last = 0.0, last_printed = 0.0, jump = 0.0, printed_jump = 0.0, worst = 0.0, printed_worst = 0.0;
  for (int draw = 0; draw < 10; ++draw) {
    const double frequency = random.uniform(0.0, settings.highest_frequency);
    Periods periods, printed_periods;
    for (int k = 0; k < kSteps; ++k, t += kStep) {
      const double now = signal.step(kStep), printed = settings.largest * std::cos(frequency * t);
      if (draw > 0 && k == 0) {
        jump = std::max(jump, std::abs(now - last));
        printed_jump = std::max(printed_jump, std::abs(printed - last_printed));
      }
      periods.see(last = now);
      printed_periods.see(last_printed = printed);
    }
    const double wanted = frequency * kSteps * kStep;
    worst = std::max(worst, std::abs(periods.count() - wanted));
    printed_worst = std::max(printed_worst, std::abs(printed_periods.count() - wanted));
  }
  CHECK(worst <= 1.0);
  CHECK(printed_worst > 50.0);  // of a hundred periods at most
  CHECK(jump < 10.0 * 2.0 * 3.1416 * 0.5 * kStep * 1.01);
  CHECK(printed_jump > 5.0);  // N, from one step to the next
}

}  // namespace fathom::excitation
