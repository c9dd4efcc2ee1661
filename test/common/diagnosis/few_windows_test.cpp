// What acts in a few windows only has its odds from these windows, by as much as they independently say; noise, however
// long its memory, convinces nobody.
#include "common/diagnosis/few_windows.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::FitResult;
using identification::TrajectoryFit;

namespace {

constexpr double kDt = 0.1;  // s, of the dives
constexpr double kDuration = 120.0;

identification::FitSettings quick() { return {.window = 5.0, .threads = 1, .iterations = 8}; }

struct Fits {
  TrajectoryFit problem;
  FitResult without, with;
  std::vector<Eigen::Index> places;  // of the suspect's numbers
};

Fits fit(const model::Vehicle& vehicle, const Trial& trial, const model::ActiveEffect& suspect) {
  Fits fits{TrajectoryFit{vehicle, {&trial, 1}, quick()}, {}, {}, {}};
  fits.without = fits.problem.fit(model::nominal_model(vehicle, false));
  model::Model model = fits.without.model;
  model.add(suspect);
  fits.with = fits.problem.fit(model, &fits.without);
  const auto all = static_cast<Eigen::Index>(identification::ParameterMap{fits.with.model}.size());
  for (auto i = static_cast<Eigen::Index>(suspect.theta.size()); i > 0; --i) fits.places.push_back(all - i);
  return fits;
}

/// Adds to the measured velocities what remembers itself for `memory` seconds, `times` the sensors' noise (RMS).
void add_drift(Trial& trial, double memory, double times, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double keeps = std::exp(-kDt / memory), size = 0.005 * times * std::sqrt(1.0 - keeps * keeps);
  Vector6d drift = Vector6d::Zero();
  for (Vector6d& nu : trial.nu) {
    for (const int axis : {0, 1, 2, 5}) {
      drift[axis] = keeps * drift[axis] + size * normal(random);
      nu[axis] += drift[axis];
    }
  }
}

}  // namespace

TEST_CASE("few windows: what acts in two of them, but there beyond doubt, has its odds from all that they say") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  constexpr double kOnset = 110.0;  // s: two windows of 24
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = kDuration,
                                .seed = 31,
                                .spread = 0.0,
                                .effects = {test::active("thruster_failure", {0.5, kOnset}, 1)}});
  const Fits clean = fit(vehicle, dive.trial, test::active("thruster_failure", {0.3, kOnset}, 1));
  const double ratio = ratio_where_it_acts(clean.problem, clean.with, clean.places);
  CHECK(ratio > 20.0);  // two observations could give hardly 8
  CHECK(clean.without.cost - clean.with.cost > 5.0 * ratio);

  // Once something else is left in the same windows, they are two observations again.
  Trial drifting = dive.trial;
  std::mt19937 random{7};
  add_drift(drifting, 2.0, 3.0, random);
  const Fits rough = fit(vehicle, drifting, test::active("thruster_failure", {0.3, kOnset}, 1));
  CHECK(ratio_where_it_acts(rough.problem, rough.with, rough.places) < 0.5 * ratio);
}

TEST_CASE("few windows: the memory of what is left is found, in seconds") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto memory = [&](double of_drift) {
    test::VirtualDive dive = test::make_dive(vehicle, {.duration = 300.0, .seed = 5, .spread = 0.0});
    std::mt19937 random{11};
    if (of_drift > 0.0) add_drift(dive.trial, of_drift, 5.0, random);
    const TrajectoryFit problem{vehicle, {&dive.trial, 1}, quick()};
    const FitResult found = problem.fit(model::nominal_model(vehicle, false));
    const auto n = static_cast<Eigen::Index>(identification::ParameterMap{found.model}.size());
    return memory_of_scores(problem, problem.linearise(found), Eigen::VectorXd::Unit(n, 4));  // X_u
  };
  const double white = memory(0.0);
  CHECK(white >= kDt);
  CHECK(white < 3.0 * kDt);             // of 3000 products the sum over some lags scatters by that
  const double coloured = memory(0.5);  // e^-t/.5 has an integrated memory of 1 s, what the motion sees of it less
  CHECK(coloured > 0.4);
  CHECK(coloured < 1.5);
}

TEST_CASE("few windows: windows that are the same with and without an effect give it no odds") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  int convinced = 0;
  for (const double memory : {0.1, 0.3, 1.0, 3.0}) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
      test::VirtualDive dive = test::make_dive(vehicle, {.duration = kDuration, .seed = seed, .spread = 0.0});
      std::mt19937 random{seed};
      add_drift(dive.trial, memory, 3.0, random);
      const Fits fits = fit(vehicle, dive.trial, test::active("current", {0.01, 0.01}));
      convinced += ratio_where_it_acts(fits.problem, fits.with, fits.places) > 7.0 ? 1 : 0;
    }
  }
  CHECK(convinced == 0);  // e^-7 each, more for what two dozen clusters leave uncertain: 24 e^-7 = .02
}
