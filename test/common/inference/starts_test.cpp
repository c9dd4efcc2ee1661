// A fit that begins where the filter has lost the motion never comes back; one that begins at less of the same does.
#include "common/inference/starts.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/likelihood/fit.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

TEST_CASE("starts: a number by which the motion is lost is made smaller, and one of ordinary size is as proposed") {
  constexpr double kOrdinary = 6.0, kFar = -1e6;  // N/(m/s)
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 40.0, .seed = 8});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const std::vector<Law> laws = catalogue(model::scene_of(vehicle, {&dive.trial, 1}), {});
  const auto law =
      std::ranges::find_if(laws, [](const Law& one) { return one.name == "cross_coupling" && one.form == "Z_u"; });
  REQUIRE(law != laws.end());
  const likelihood::Hypothesis from = likelihood::nominal_hypothesis(problem);
  const likelihood::Noise noise = likelihood::prior_noise(problem);
  const auto begun = [&](double coefficient) {
    model::ActiveEffect coupling = law->seed;
    coupling.theta[0] = coefficient;
    return start_of(problem, laws, from, {coupling}, noise);
  };
  const auto coefficient_of = [](const auto& one) { return one.hypothesis.model.effects.at(0).theta[0]; };
  CHECK(coefficient_of(begun(kOrdinary)) == kOrdinary);
  const Start less = begun(kFar);
  CHECK(coefficient_of(less) > 1e-2 * kFar);
  CHECK(coefficient_of(less) < 0.0);
  likelihood::Hypothesis far = less.hypothesis;
  far.model.effects.at(0).theta[0] = kFar;
  const likelihood::FitOptions options{.noise_rounds = 2};
  const likelihood::Fit lost = likelihood::fit(problem, far, noise, options),
                        found = likelihood::fit(problem, less.hypothesis, noise, options);
  REQUIRE(found.finite);
  // Both have the same numbers to move; from afar the fit stays a thousand nats below.
  CHECK((!lost.finite || found.log_likelihood > lost.log_likelihood + 100.0));
  CHECK(std::abs(coefficient_of(found)) < 1.0);  // nothing couples here
}
