// Long recordings: the search looks at stretches, and what it says is about all of them.
#include "common/inference/stretches.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/inference/infer.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::inference;

TEST_CASE("stretches: spread over every run, of the length that was asked, in the runs' own time") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto one = test::fly(vehicle, {.duration = 600.0, .dt = 0.1, .seed = 1});
  const auto other = test::fly(vehicle, {.duration = 200.0, .dt = 0.1, .seed = 2});
  const std::vector<Trial> trials{one.trial, other.trial};
  const likelihood::Problem whole = likelihood::make_problem(vehicle, trials);
  CHECK_FALSE(stretches_of(whole, {.search_blocks = 4100.0}).has_value());
  const auto stretches = stretches_of(whole, {.search_blocks = 2000.0});
  REQUIRE(stretches.has_value());
  REQUIRE(stretches->trials.size() == stretches->run.size());
  double blocks = 0.0;
  for (std::size_t s = 0; s < stretches->trials.size(); ++s) {
    const Trial& part = stretches->trials[s];
    const Trial& run = trials[stretches->run[s]];
    blocks += static_cast<double>(part.size());
    const auto from = static_cast<std::size_t>(std::lround((part.t.front() - run.t.front()) / run.dt));
    REQUIRE(from + part.size() <= run.size());
    CHECK(part.nu.front() == run.nu[from]);
    CHECK(part.input.back() == run.input[from + part.size() - 1]);
    // Forty times what is filtered and not scored, or what is the run's share.
    CHECK(part.t.back() - part.t.front() > (stretches->run[s] == 0 ? 79.0 : 49.0));
  }
  CHECK(std::ranges::count(stretches->run, 1U) == 1);
  CHECK(blocks == doctest::Approx(2000.0).epsilon(0.02));
}

TEST_CASE("stretches: what belongs to a run begins at the mean over its stretches") {
  Stretches stretches;
  stretches.run = {0, 0, 1};
  likelihood::Fit fit;
  fit.hypothesis.runs.resize(3);
  fit.hypothesis.runs[0].command_offset = 0.01;
  fit.hypothesis.runs[1].command_offset = 0.03;
  fit.hypothesis.runs[2].command_offset = -0.01;
  const Start start = on_whole_runs(fit, stretches, 2);
  REQUIRE(start.hypothesis.runs.size() == 2);
  CHECK(start.hypothesis.runs[0].command_offset == doctest::Approx(0.02));
  CHECK(start.hypothesis.runs[1].command_offset == doctest::Approx(-0.01));
}

TEST_CASE("stretches: what acts is named, with the numbers and the odds of all recordings") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(
      vehicle, {.duration = 240.0, .seed = 7, .force = 0.05, .effects = {test::active("current", {0.1, 0.05})}});
  const Conclusion on_all = infer(vehicle, {&dive.trial, 1}, {}, {});
  Settings settings;
  settings.thresholds.search_blocks = 2000.0;
  const Conclusion ahead = infer(vehicle, {&dive.trial, 1}, settings, {});
  REQUIRE(on_all.found.best.names == std::vector<std::string>{"current"});
  REQUIRE(ahead.found.best.names == on_all.found.best.names);
  CHECK(ahead.verdict == on_all.verdict);
  CHECK(ahead.found.best.fit.scored == on_all.found.best.fit.scored);
  CHECK(ahead.found.odds[0] > 100.0);
  const likelihood::Fit &a = ahead.found.best.fit, &b = on_all.found.best.fit;
  const Eigen::VectorXd sigma = b.sigma();
  for (std::size_t j = 0; j < b.numbers.size(); ++j) {
    CAPTURE(b.numbers[j].name);
    // Of one recording, by one likelihood, under two choices of the noise's tails.
    CHECK(std::abs(value(a.hypothesis, a.numbers[j]) - value(b.hypothesis, b.numbers[j])) <
          0.6 * sigma[static_cast<Eigen::Index>(j)]);
  }
}
