// What a residual goes with: structure that is put in is named, noise with a memory is not, although a pilot answers
// it.
#include "common/diagnosis/associations.hpp"

#include <doctest/doctest.h>

#include "test/common/diagnosis/made_up_runs.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

TEST_CASE("associations: noise goes with nothing, whatever its memory and however a pilot answers it") {
  int found = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const double memory = std::array{0.0, 0.5, 2.0, 5.0}[seed % 4];
    const double answer = seed % 8 < 4 ? 0.0 : 40.0;
    const auto left = Dive{seed, memory, answer, {}, seed % 16 < 8 ? 4.0 : 20.0}.left();
    for (const Association& one : left) MESSAGE(seed << ": " << one.with << " " << one.share << " " << one.log_odds);
    found += left.empty() ? 0 : 1;
  }
  CHECK(found == 0);
}

TEST_CASE("associations: half a minute of noise goes with nothing either") {
  constexpr std::size_t kShort = 660;
  const unsigned kSeeds = test::seeds(400);
  int found = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const double memory = std::array{0.0, 0.5, 2.0, 5.0}[seed % 4];
    const double answer = seed % 8 < 4 ? 0.0 : 40.0;
    const auto left = Dive{seed, memory, answer, {}, seed % 16 < 8 ? 4.0 : 20.0, kShort}.left();
    for (const Association& one : left) MESSAGE(seed << ": " << one.with << " " << one.share << " " << one.log_odds);
    found += left.empty() ? 0 : 1;
  }
  CHECK(found <= 4);  // e^-5 each, and Student's tails
}

TEST_CASE("associations: nor does it with few samples for each of many columns") {
  const unsigned kSeeds = test::seeds(1300);
  int found = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const auto left = Tumble{seed}.left();
    for (const Association& one : left) MESSAGE(seed << ": " << one.with << " " << one.share << " " << one.log_odds);
    found += left.empty() ? 0 : 1;
  }
  CHECK(found <= 4);  // 2 at the time of writing; 8 when all samples count as free
}

TEST_CASE("associations: what is small beside the thrust is none, however sure it is") {
  const Dive dive{3, 0.0, 0.0, [](const Trial& t, std::size_t k) { return 2.0 * std::abs(t.nu[k][0]); }};
  const auto all = dive.left();
  REQUIRE(among(all, "speed"));
  const auto speed = std::ranges::find(all, std::string{"speed"}, &Association::with);
  REQUIRE(speed != all.end());
  CHECK(speed->of_wrench > 0.01);
  CHECK(speed->of_wrench < 0.2);
  CHECK(among(dive.left(0.9 * speed->of_wrench), "speed"));
  CHECK_FALSE(among(dive.left(1.1 * speed->of_wrench), "speed"));
}

TEST_CASE("associations: what is put in is named, in noise with a memory, and with the share that it has") {
  struct Case {
    const char* with;
    Dive::Structure structure;
  };
  const std::vector<Case> cases{
      {"position", [](const Trial& t, std::size_t k) { return 4.0 * t.p_WB[k].y(); }},
      {"depth", [](const Trial& t, std::size_t k) { return 8.0 * t.p_WB[k].z(); }},
      {"heading, like a force that is steady in the world",
       [](const Trial& t, std::size_t k) { return 3.0 * std::cos(heading(t, k)); }},
      {"heading", [](const Trial& t, std::size_t k) { return 3.0 * std::cos(2.0 * heading(t, k)); }},
      {"speed", [](const Trial& t, std::size_t k) { return 4.0 * std::abs(t.nu[k][0]); }},
      {"thrust", [](const Trial& t, std::size_t k) { return 0.2 * std::abs(t.input[k][0]); }},
      {"thrust a moment ago", [](const Trial& t, std::size_t k) { return k < 14 ? 0.0 : 0.2 * t.input[k - 14][0]; }},
      {"heading and time, like a force in the world that changes slowly",
       [](const Trial& t, std::size_t k) { return 12.0 * std::cos(heading(t, k)) * std::sin(0.06 * t.t[k] + 1.0); }},
      {"heading and time, like a force in the world that swings with 0.014",
       [](const Trial& t, std::size_t k) { return 3.0 * std::cos(heading(t, k) - 0.09 * t.t[k]); }},
      {"time, swinging slowly", [](const Trial& t, std::size_t k) { return 4.0 * std::sin(0.06 * t.t[k]); }},
      {"time, as a drift", [](const Trial& t, std::size_t k) { return 0.03 * t.t[k]; }},
      {"time, as thrust or drag that changes",
       [](const Trial& t, std::size_t k) { return 0.001 * t.t[k] * t.input[k][0]; }},
      {"a step at 1", [](const Trial& t, std::size_t k) { return t.t[k] > 140.0 ? 4.0 : 0.0; }},
      {"bursts of no recorded cause",
       [](const Trial& t, std::size_t k) { return episode(t.t[k]) ? 12.0 * std::sin(1.9 * t.t[k]) : 0.0; }},
      {"an oscillation of 0.2",
       [](const Trial& t, std::size_t k) { return 2.0 * std::sin(2.0 * std::numbers::pi * 0.2 * t.t[k]); }}};
  for (const Case& each : cases) {
    const auto left = Dive{7, 0.5, 10.0, each.structure}.left();
    CHECK_MESSAGE(among(left, each.with), std::string{each.with} << " is not among " << left.size()
                                                                 << (left.empty() ? "" : ": " + left[0].with));
    for (const Association& one : left) {
      CHECK(one.axis == "X");
      CHECK(one.share <= 1.0);
    }
  }
  const auto left = Dive{8, 0.5, 10.0, cases[0].structure}.left();
  REQUIRE_FALSE(left.empty());
  CHECK(left.front().with == "position");
  CHECK(left.front().share == doctest::Approx(8.0 / 9.0).epsilon(0.1));  // variances 4^2 / 2 of it, 1 of the noise
}

TEST_CASE("associations: thrust that is lost now and then comes in bursts, whose size goes with thrust") {
  const auto air = [](const Trial& t, std::size_t k) {  // more and less of it every half second
    const double n = std::floor(2.0 * t.t[k]);
    return episode(t.t[k]) ? -(0.5 + 0.5 * std::sin(9.7 * n * n)) * t.input[k][0] : 0.0;
  };
  int found = 0, with_thrust = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto left = Dive{seed, 0.5, 10.0, air, 60.0}.left();
    found += among(left, "bursts") ? 1 : 0;
    with_thrust += among(left, "bursts, whose size goes with thrust") ? 1 : 0;
    CHECK_FALSE(among(left, "bursts, whose size goes with depth"));
  }
  CHECK(found == 20);
  CHECK(with_thrust >= 10);  // 12 at the time of writing: bursts are few, and only evidence names what they go with
}

TEST_CASE("associations: noise of moments that grows with the speed is no burst, the same of a force is") {
  for (const int axis : {0, 5}) {
    Tumble tumble{4, 600};
    for (std::size_t k = 0; k < tumble.trials[0].size(); ++k)
      tumble.residuals[0][k][axis] *= std::pow(tumble.trials[0].nu[k][1], 2);
    CHECK(among(tumble.left(), "bursts") == (axis == 0));
  }
}

TEST_CASE("associations: a run without the quantity is left out, a run too short tells nothing") {
  Dive dive{3, 0.5, 10.0, [](const Trial& t, std::size_t k) { return 4.0 * t.p_WB[k].y(); }};
  dive.trials[0].observed.position = false;
  CHECK_FALSE(among(dive.left(), "position"));
  Dive brief{3};
  Trial& trial = brief.trials[0];
  for (auto* flags : {&trial.pose_valid, &trial.velocity_valid, &trial.rates_valid}) flags->resize(60);
  trial.t.resize(60);
  trial.p_WB.resize(60);
  trial.q_WB.resize(60);
  trial.nu.resize(60);
  trial.input.resize(60);
  brief.residuals[0].resize(60);
  CHECK(brief.left().empty());
  // Runs of nothing beside a good one: left out.
  Dive whole{9, 0.5, 10.0, [](const Trial& t, std::size_t k) { return 4.0 * t.p_WB[k].y(); }};
  whole.trials.insert(whole.trials.begin(), Trial{.dt = kDt});
  whole.residuals.insert(whole.residuals.begin(), std::vector<Vector6d>{});
  CHECK(among(whole.left(), "position"));
}

TEST_CASE("associations: a free curve is believed when the residual goes with it, and not for noise with a memory") {
  const FreeCurve north{0, Quantity::kNorth, -2.0, 2.0, 1.0, true}, depth{0, Quantity::kDepth, 1.5, 2.5, 1.0, true};
  const auto bump = [](const Trial& t, std::size_t k) {
    return 4.0 * std::exp(-std::pow((t.p_WB[k].z() - 2.2) / 0.1, 2));
  };
  const Dive bumped{4, 0.5, 10.0, bump}, noisy{5, 3.0, 40.0};
  const LeftOver of_bump{bumped.model, bumped.trials, bumped.residuals},
      of_noise{noisy.model, noisy.trials, noisy.residuals};
  CHECK(of_bump.log_odds(depth) > 20.0);
  CHECK(of_bump.log_odds(north) < 5.0);
  CHECK(of_noise.log_odds(depth) < 0.0);
  CHECK(of_noise.log_odds(north) < 0.0);
}
