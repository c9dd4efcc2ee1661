#include "common/likelihood/noise_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/likelihood/fit.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

TEST_CASE("noise: random forces and sensor noises that were drawn come out") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  struct Drawn {
    double force, force_memory, sensor, colour, colour_memory;
  };
  for (const Drawn drawn :
       {Drawn{0.05, 0.8, 0.002, 0.0, 0.1}, Drawn{0.1, 3.0, 0.004, 0.0, 0.1}, Drawn{0.03, 1.0, 0.002, 0.004, 0.1}}) {
    const auto dive = test::fly(vehicle, {.duration = 200.0,
                                          .seed = 5,
                                          .force = drawn.force,
                                          .force_memory = drawn.force_memory,
                                          .sensor = drawn.sensor,
                                          .colour = drawn.colour,
                                          .colour_memory = drawn.colour_memory});
    const Problem problem = make_problem(vehicle, {&dive.trial, 1});
    const Fit found = fit(problem, nominal_hypothesis(problem), prior_noise(problem), {.noise_rounds = 6});
    REQUIRE(found.finite);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const AxisNoise& noise = found.noise[axis];
      CAPTURE(axis);
      CAPTURE(drawn.force);
      // Two hundred seconds hold a hundred and fewer memories: a tenth of sigma, a quarter of the memory.
      CHECK(noise[kForce] == doctest::Approx(drawn.force).epsilon(0.25));
      CHECK(std::abs(std::log(noise[kForceMemory] / drawn.force_memory)) < 0.6);
      if (drawn.colour == 0.0) {
        CHECK(noise[kSensor] == doctest::Approx(drawn.sensor).epsilon(0.06));
        CHECK(noise[kColoured] < 0.5 * drawn.sensor);
      } else {
        CHECK(noise[kColoured] == doctest::Approx(drawn.colour).epsilon(0.2));
        CHECK(noise[kColourMemory] == doctest::Approx(drawn.colour_memory).epsilon(0.3));
      }
    }
  }
}

TEST_CASE("noise: the linearised filter is the filter itself, where nothing has moved") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 30.0, .force = 0.05});
  const Problem problem = make_problem(vehicle, {&dive.trial, 1});
  Hypothesis hypothesis = nominal_hypothesis(problem);
  hypothesis.model = dive.truth;
  Noise noise = prior_noise(problem);
  for (const Tail tail : {Tail{}, Tail{4.0, false}, Tail{4.0, true}}) {
    for (AxisNoise& axis : noise) axis.tail = tail;
    const PassResult seen = pass(problem, hypothesis, problem.numbers(hypothesis), noise, {.reduced = true});
    double sum = 0.0;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(problem.simulated); ++axis) {
      const std::vector<ReducedBlock>* blocks = &seen.reduced[0][axis];
      sum += reduced_log_likelihood({&blocks, 1}, noise[axis]);
    }
    // What couples the axes is left out of the reduced filter's covariances.
    CHECK(sum == doctest::Approx(seen.log_likelihood).epsilon(5e-3));
  }
}

TEST_CASE("noise: a heavy tail and a scale that varies are recognised, and neither where there is none") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto tails_of = [&](auto factor) {
    const auto dive = test::fly(vehicle, {.duration = 100.0, .sensor_factor = factor});
    const Problem problem = make_problem(vehicle, {&dive.trial, 1});
    return fit(problem, nominal_hypothesis(problem), prior_noise(problem), {.choose_tail = true}).noise;
  };
  const Noise constant = tails_of([](double, std::mt19937&) { return 1.0; });
  const Noise bursts = tails_of([](double t, std::mt19937&) { return std::fmod(t, 20.0) < 8.0 ? 4.0 : 1.0; });
  const Noise heavy = tails_of(
      [](double, std::mt19937& random) { return std::sqrt(3.0 / std::chi_squared_distribution<double>{3.0}(random)); });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    CHECK(constant[axis].tail == Tail{});
    CHECK(bursts[axis].tail.follows);
    CHECK(heavy[axis].tail.freedom > 0.0);
  }
}
