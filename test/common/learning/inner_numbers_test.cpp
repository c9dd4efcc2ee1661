// Frequencies of swings: found where they are, from wherever a coarse search has left them.
#include "common/learning/inner_numbers.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/common/learning/learned_case.hpp"

using namespace fathom;
using namespace fathom::learning;

TEST_CASE("frequencies: a swing's frequency is found within what the recording tells of it") {
  constexpr double kOmega = 1.37, kDuration = 80.0;
  // Four standard deviations: var = 12 S / (A^2 T^3), A = .08 m/s^2 the swing's size, S = 4 sigma^2 tau / (1 + (omega
  // tau)^2) twice the density of a random force of sigma = .005 m/s^2, tau = .8 s (Rife and Boorstyn 1974).
  constexpr double kSure = 4.0 * 0.00037;  // rad/s
  const auto shaken = [](double t, const Vector6d&) {
    return Vector6d{0.08 * std::cos(kOmega * t) * Vector6d::Unit(2)};
  };
  const test::LearnedCase dive{{.duration = kDuration, .seed = 5, .force = 0.005, .outside = shaken}, false};
  likelihood::Hypothesis start = dive.conclusion.found.best.fit.hypothesis;
  for (const model::Quantity quantity : {model::Quantity::kToneCosine, model::Quantity::kToneSine}) {
    model::Feature swing{.axis = model::kWorldAxis + 2, .count = 1};
    swing.factors[0] = {.quantity = quantity, .a = kOmega + 0.8 / kDuration};  // 0.4 rad at the ends
    start.force.features.push_back(swing);
    start.force.weights.push_back(0.0);
  }
  start.force.groups.push_back(
      {.kind = "a swing", .axis = model::kWorldAxis + 2, .count = 2, .sigma = 10.0, .closed = true});
  const likelihood::Fit coarse =
      likelihood::fit(dive.problem, start, dive.conclusion.found.best.fit.noise, {.noise_rounds = 3, .threads = 2});
  REQUIRE(coarse.finite);
  const likelihood::Fit fine = with_inner_numbers(dive.problem, coarse, 2);
  CHECK(fine.log_evidence > coarse.log_evidence);
  const auto& features = fine.hypothesis.force.features;
  CHECK(features[0].factors[0].a == features[1].factors[0].a);  // one number
  CHECK(std::abs(features[0].factors[0].a - kOmega) < kSure);
  // And a force that does not swing stays what it is.
  const likelihood::Fit still = with_inner_numbers(dive.problem, dive.conclusion.found.best.fit, 2);
  CHECK(still.log_evidence == dive.conclusion.found.best.fit.log_evidence);
}
