// What begins in the runs that judge is seen, and noise is none of it, with or without a memory.
#include "common/residual/unseen_event.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace fathom::residual {
namespace {

constexpr double kDt = 0.05;  // s

struct Run {
  Trial trial;
  std::vector<Vector6d> residual;
};

/// Noise of 1 N along X that forgets itself after `memory` s; from `onset` on, `more` N besides.
Run run(unsigned seed, double begin, double length, double memory, double onset, double more) {
  Run made{{.name = "run " + std::to_string(seed), .dt = kDt}, {}};
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  const double keep = memory > 0.0 ? std::exp(-kDt / memory) : 0.0;
  double noise = normal(random);
  for (double t = begin; t < begin + length; t += kDt) {
    noise = keep * noise + std::sqrt(1.0 - keep * keep) * normal(random);
    made.trial.t.push_back(t);
    made.residual.emplace_back((noise + (t >= onset ? more : 0.0)) * Vector6d::Unit(0));
  }
  return made;
}

std::optional<UnseenEvent> asked(const Run& fitted, const Run& unseen) {
  return unseen_event({&fitted.trial, 1}, {&fitted.residual, 1}, {&unseen.trial, 1}, {&unseen.residual, 1});
}

}  // namespace

TEST_CASE("unseen event: found with its run and its moment") {
  for (const double onset : {236.0, 260.0, 290.0}) {
    const auto found = asked(run(1, 0.0, 231.0, 0.2, 1e9, 0.0), run(2, 231.0, 99.0, 0.2, onset, 5.0));
    REQUIRE(found.has_value());
    CHECK(found->run == "run 2");
    CHECK(std::abs(found->t - onset) < 3.0);  // a few samples of half a second
  }
}

TEST_CASE("unseen event: none where more than noise is left in what was fitted, and none of noise") {
  CHECK_FALSE(asked(run(1, 0.0, 231.0, 0.2, 100.0, 5.0), run(2, 231.0, 99.0, 0.2, 0.0, 50.0)).has_value());
  int alarms = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const double memory = seed % 2 == 0 ? 0.0 : 5.0;  // s: as long as any noise that a trial was seen to have
    const auto found =
        asked(run(2 * seed, 0.0, 231.0, memory, 1e9, 0.0), run(2 * seed + 1, 231.0, 99.0, memory, 1e9, 0.0));
    alarms += found.has_value() ? 1 : 0;
  }
  CHECK(alarms == 0);  // one more look is all that an alarm would cost
}

TEST_CASE("unseen event: nothing is told by a run that is too short, nor where nothing was measured") {
  CHECK_FALSE(asked(run(1, 0.0, 231.0, 0.0, 1e9, 0.0), run(2, 231.0, 15.0, 0.0, 235.0, 50.0)).has_value());
  Run blind = run(2, 231.0, 99.0, 0.0, 235.0, 50.0);
  for (Vector6d& residual : blind.residual) residual.setConstant(std::nan(""));
  CHECK_FALSE(asked(run(1, 0.0, 231.0, 0.0, 1e9, 0.0), blind).has_value());
}

}  // namespace fathom::residual
