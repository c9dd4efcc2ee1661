// The stretches between a run's gaps: nothing of a gap is in them, their time goes on, and what is too short is left
// out.
#include "common/estimation/split.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <tuple>

#include "common/base/error.hpp"

namespace fathom::estimation {
namespace {

/// 10 s, without input in [3 s, 4 s) and [8.5 s, 9 s).
Trial torn() {
  Trial trial{.name = "dive", .dt = 0.1};
  for (int i = 0; i < 100; ++i) {
    trial.t.push_back(0.1 * i);
    trial.nu.push_back(Vector6d::Constant(i));
    trial.input.push_back(Eigen::VectorXd::Constant(6, i));
    for (int part = 0; part < 2; ++part) {
      trial.held.push_back(Eigen::VectorXd::Constant(6, 2 * i + part));
      trial.told.push_back(trial.held.back());
    }
    trial.input_valid.push_back((i >= 30 && i < 40) || (i >= 85 && i < 90) ? 0 : 1);
  }
  return trial;
}

}  // namespace

TEST_CASE("split: what judges is the end, both ends or the beginning, and nothing is in two parts") {
  const Trial run = torn();
  for (const auto& [kept, from, to] :
       {std::tuple{Kept::kLast, 0, 70}, {Kept::kEnds, 15, 85}, {Kept::kFirst, 30, 100}}) {
    const Parts parts = split(run, 0.3, kept);
    CHECK(parts.fitted.nu.front()[0] == from);
    CHECK(parts.fitted.nu.back()[0] == to - 1);
    std::size_t judged = 0;
    for (const Trial& part : parts.judged) {
      judged += part.size();
      CHECK((part.t.back() < parts.fitted.t.front() || part.t.front() > parts.fitted.t.back()));
      CHECK(part.held.size() == 2 * part.size());
    }
    CHECK(judged == 30);
  }
  CHECK(split(run, 0.3, Kept::kEnds).fitted.name == "dive (middle 70 %)");
  CHECK(split(run, 0.3, Kept::kEnds).judged[1].name == "dive (last 15 %)");
  CHECK(split(run, 0.3, Kept::kFirst).judged[0].name == "dive (first 30 %)");
  Trial two = run;
  two.t.resize(2);
  CHECK_THROWS_AS((void)split(two, 0.3, Kept::kEnds), InputError);
}

TEST_CASE("known stretches: each is a trial under the run's name, and what is too short is left out") {
  const std::vector<Trial> known = known_stretches(torn(), 2.0);
  REQUIRE(known.size() == 2);
  CHECK(known[0].size() == 30);
  CHECK(known[1].size() == 45);
  CHECK(known[1].t.front() == doctest::Approx(4.0));
  CHECK(known[1].nu.front()[0] == 40.0);
  CHECK(known[1].held.size() == 90);
  CHECK(known[1].told.front()[0] == 80.0);
  for (const Trial& trial : known) {
    CHECK(trial.name == "dive");
    CHECK(std::ranges::count(trial.input_valid, 0) == 0);
  }
  CHECK(known_stretches(torn(), 0.5).size() == 3);
  CHECK(known_stretches(torn(), 5.0).empty());
}

TEST_CASE("known stretches: a run without gaps stays one trial, however short") {
  Trial trial = torn();
  trial.input_valid.assign(trial.size(), 1);
  REQUIRE(known_stretches(trial, 60.0).size() == 1);
  CHECK(known_stretches(trial, 60.0)[0].size() == trial.size());
  trial.input_valid.clear();
  CHECK(known_stretches(trial, 60.0).size() == 1);
  CHECK(input_gaps(trial).count == 0);
}

TEST_CASE("input gaps: counted, with their lengths from the last to the next input") {
  const InputGaps gaps = input_gaps(torn());
  CHECK(gaps.count == 2);
  CHECK(gaps.longest == doctest::Approx(1.1));
  CHECK(gaps.total == doctest::Approx(1.7));
}

TEST_CASE("input gaps: one finding for each run that has any") {
  Trial whole = torn();
  whole.input_valid.clear();
  const std::vector<Trial> runs{whole, torn()};
  const std::vector<ConsistencyFinding> findings = gap_findings(runs);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].run == runs[1].name);
  CHECK(findings[0].signal == "thrusters");
  CHECK(findings[0].finding == "gap");
  CHECK(findings[0].size == doctest::Approx(1.1));
}

}  // namespace fathom::estimation
