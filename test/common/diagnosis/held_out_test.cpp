// An effect earns its place on data that did not size it: true ones carry over to other blocks and other runs, chance
// does not, and what acted in one run only is told from what always acts.
#include "common/diagnosis/held_out.hpp"

#include <doctest/doctest.h>

#include <array>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::FitResult;
using identification::TrajectoryFit;

namespace {

constexpr double kWorthwhile = 0.05;  // of the error; the effects below are chosen to be plainly visible
constexpr double kChance = 2e-3;      // of the error: what an absent effect may seem to save or cost

identification::FitSettings quick() { return {.window = 5.0, .threads = 1, .iterations = 8}; }

struct Runs {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  std::vector<test::VirtualDive> dives;
  std::vector<Trial> trials;

  /// One dive of the same vehicle per list of effects.
  explicit Runs(const std::vector<std::vector<model::ActiveEffect>>& effects, double duration, double turn = 0.0,
                double spread = 0.0) {
    for (std::size_t r = 0; r < effects.size(); ++r) {
      dives.push_back(test::make_dive(vehicle, {.duration = duration,
                                                .seed = 31 + static_cast<unsigned>(r),
                                                .turn = turn,
                                                .spread = spread,
                                                .effects = effects[r]}));
      trials.push_back(dives.back().trial);
    }
  }

  struct Fits {
    FitResult without, with;
    std::vector<Eigen::Index> places;
  };
  /// Fits without and with the effect `suspect`, whose numbers start at `start`.
  [[nodiscard]] Fits fit(const TrajectoryFit& problem, const std::string& suspect, const std::vector<double>& start,
                         int variant = 0) const {
    Fits fits{problem.fit(model::nominal_model(vehicle, false)), {}, {}};
    model::Model model = fits.without.model;
    model.add(test::active(suspect, start, variant));
    fits.with = problem.fit(model, &fits.without);
    const auto all = static_cast<Eigen::Index>(identification::ParameterMap{fits.with.model}.size());
    for (auto i = static_cast<Eigen::Index>(start.size()); i > 0; --i) fits.places.push_back(all - i);
    return fits;
  }
  [[nodiscard]] HeldOut judge(const std::string& suspect, const std::vector<double>& start) const {
    const TrajectoryFit problem{vehicle, trials, quick()};
    const Fits fits = fit(problem, suspect, start);
    return held_out(problem, CrossValidation{problem, fits.without}, CrossValidation{problem, fits.with}, fits.places);
  }
};

}  // namespace

TEST_CASE("held out: a true effect saves error on windows that did not size it") {
  const Runs runs{{{test::active("current", {0.08, -0.05})}}, 120.0};
  const HeldOut carried = runs.judge("current", {0.01, 0.01});
  CHECK(carried.blocks > kWorthwhile);
  CHECK(carried.runs == carried.blocks);  // one run: there is no other to ask
}

TEST_CASE("held out: an absent effect saves nothing") {
  const Runs runs{{{}}, 120.0};
  const HeldOut carried = runs.judge("current", {0.01, 0.01});
  CHECK(std::abs(carried.blocks) < kChance);
}

TEST_CASE("held out: no change saves exactly nothing") {
  const Runs runs{{{}}, 40.0};
  const TrajectoryFit problem{runs.vehicle, runs.trials, quick()};
  const FitResult fit = problem.fit(model::nominal_model(runs.vehicle, false));
  const HeldOut same = held_out(problem, CrossValidation{problem, fit}, CrossValidation{problem, fit}, {});
  CHECK(same.blocks == 0.0);
  CHECK(same.runs == 0.0);
}

TEST_CASE("held out: axes that are driven one after the other do not cost a true effect its place") {
  // Each axis fills one block of three windows: no other block tells of its drag and mass, which the file has wrong.
  constexpr double kSpread = 0.3;
  const Runs asymmetric{{{test::active("thrust_asymmetry", {0.03})}}, 60.0, 15.0, kSpread};
  CHECK(asymmetric.judge("thrust_asymmetry", {0.02}).blocks > kWorthwhile);
  const Runs clean{{{}}, 60.0, 15.0, kSpread};
  CHECK(std::abs(clean.judge("thrust_asymmetry", {0.02}).blocks) < 10.0 * kChance);  // four windows size it, not 24
}

TEST_CASE("held out: what acted in one run of three helps its own blocks, but does not carry over to other runs") {
  const Runs everywhere{{{test::active("current", {0.08, -0.05})},
                         {test::active("current", {0.08, -0.05})},
                         {test::active("current", {0.08, -0.05})}},
                        60.0};
  const HeldOut always = everywhere.judge("current", {0.01, 0.01});
  CHECK(always.runs > kWorthwhile);
  const Runs single{{{test::active("current", {0.12, -0.08})}, {}, {}}, 60.0};
  const HeldOut once = single.judge("current", {0.01, 0.01});
  CHECK(once.runs < once.blocks);
  CHECK(once.runs < kChance);
}
