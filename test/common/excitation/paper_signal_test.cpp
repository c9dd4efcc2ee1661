// Algorithm 1 of Karras et al.: its three submodes, its draws, and what its printed form would do.
#include "common/excitation/paper_signal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace fathom::excitation {
namespace {

const PaperSignalSettings kSettings{
    .largest = 10.0, .low_share = 0.4, .highest_frequency = 0.5, .submode_steps = 200, .interval_steps = 50};
constexpr double kStep = 0.05;  // s

}  // namespace

TEST_CASE("algorithm 1: periodic, small steps and large steps follow each other, and the draws keep their bounds") {
  PaperSignal signal{kSettings, 7};
  std::set<int> seen;
  std::vector<int> order;
  int positive = 0, negative = 0;
  for (int k = 0; k < 20'000; ++k) {
    const double tau = signal.step(kStep);
    const int submode = signal.submode();
    if (order.empty() || order.back() != submode) order.push_back(submode);
    seen.insert(submode);
    if (submode == 0) CHECK(std::abs(tau) <= 10.0);
    if (submode == 1) CHECK(std::abs(tau) <= 4.0);
    if (submode == 2) {
      CHECK(std::abs(tau) >= 4.0);
      CHECK(std::abs(tau) <= 10.0);
      (tau > 0.0 ? positive : negative) += 1;
    }
  }
  CHECK(seen.size() == 3);
  for (std::size_t i = 1; i < order.size(); ++i) CHECK(order[i] == (order[i - 1] + 1) % 3);
  CHECK(std::min(positive, negative) > 0.3 * std::max(positive, negative));
}

TEST_CASE("algorithm 1: one seed gives one signal, another seed another") {
  PaperSignal a{kSettings, 7}, b{kSettings, 7}, c{kSettings, 8};
  double differ = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double x = a.step(kStep);
    CHECK(x == b.step(kStep));
    differ += std::abs(x - c.step(kStep));
  }
  CHECK(differ > 100.0);
}

TEST_CASE("algorithm 1 as printed: the cosine is only evaluated with a new draw, so that nothing is periodic") {
  // The printed loop, line by line, in its submode 0.
  PaperSignalSettings settings = kSettings;
  settings.submode_steps = 1'000'000;
  Random random{7};
  double tau = 0.0, frequency = 0.0;
  int count = settings.interval_steps, changes = 0;
  PaperSignal corrected{settings, 7};
  double last = 0.0, last_corrected = 0.0, largest_jump = 0.0;
  int corrected_changes = 0;
  for (int k = 0; k < 1000; ++k) {
    if (count >= settings.interval_steps) {
      frequency = random.uniform(0.0, settings.highest_frequency);
      tau = settings.largest * std::cos(frequency * k * kStep);
      count = 0;
    }
    ++count;
    changes += tau != last ? 1 : 0;
    last = tau;
    const double now = corrected.step(kStep);
    corrected_changes += now != last_corrected ? 1 : 0;
    if (k > 0) largest_jump = std::max(largest_jump, std::abs(now - last_corrected));
    last_corrected = now;
  }
  CHECK(changes <= 20);                                            // a staircase
  CHECK(corrected_changes > 990);                                  // a wave
  CHECK(largest_jump < 10.0 * 2.0 * 3.1416 * 0.5 * kStep * 1.01);  // whose phase goes on when its frequency changes
}

TEST_CASE("algorithm 1: when it turns, what pushed one way pushes the other") {
  for (const int steps : {150, 250, 450}) {  // in each submode
    PaperSignal a{kSettings, 3}, b{kSettings, 3};
    double before = 0.0;
    for (int k = 0; k < steps; ++k) {
      before = a.step(kStep);
      b.step(kStep);
    }
    a.turn();
    const double turned = a.step(kStep), straight = b.step(kStep);
    CHECK(turned == doctest::Approx(-straight).epsilon(1e-9));
    CHECK(std::abs(straight - before) < 2.0);
  }
}

}  // namespace fathom::excitation
