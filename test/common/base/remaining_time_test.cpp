// How well the time that is left is foretold, on work whose costs are drawn: no phase costs what was guessed.
#include "common/base/remaining_time.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace fathom {
namespace {

/// A listener with a clock of its own.
struct Watched {
  Watched() : progress{[this](const Progress::Event& event) { remaining.take(now, event); }} {}
  [[nodiscard]] double left() const { return remaining.left(now).value(); }

  double now{1000.0};  // any origin
  RemainingTime remaining;
  Progress progress;
};

/// What was foretold at some moment, and what it came to.
struct Foretold {
  double begun;  ///< share of the time that had passed
  double ratio;  ///< foretold over true
};

double share_within(const std::vector<Foretold>& all, double from, double factor) {
  double inside = 0.0, count = 0.0;
  for (const Foretold& one : all) {
    if (one.begun < from || one.begun > 0.95) continue;
    count += 1.0;
    inside += std::abs(std::log(one.ratio)) < std::log(factor) ? 1.0 : 0.0;
  }
  REQUIRE(count > 500);
  return inside / count;
}

std::vector<Foretold> against(const std::vector<std::pair<double, double>>& said, double begin, double end) {
  std::vector<Foretold> all;
  for (const auto& [at, left] : said) {
    if (at < end) all.push_back({(at - begin) / (end - begin), left / (end - at)});
  }
  return all;
}

/// A search as a diagnosis makes it: rounds of many small questions and a few fits; how many rounds it takes shows only
/// as it goes on. Costs of units are log-normal about a mean per phase that is up to five times off the guess, and grow
/// from round to round as the model does.
struct Searched {
  std::vector<Foretold> measured, fixed;  ///< by RemainingTime; by shares of the whole that are written in the program
};

Searched search(std::mt19937_64& random, bool rounds_known) {
  Watched work;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> off{-std::log(5.0), std::log(5.0)};
  std::uniform_int_distribution<int> how_many{1, 4};
  const int rounds = how_many(random);
  const double question = 0.1 * std::exp(off(random)), fit = 1.0 * std::exp(off(random)),
               last = 8.0 * std::exp(off(random));
  std::vector<std::pair<double, double>> said, by_share;
  const double begin = work.now;
  double written = 0.0;  // share
  const auto unit = [&](const char* phase, double mean) {
    work.progress.begin(phase, phase);
    const double cost = mean * std::exp(0.5 * normal(random));
    for (int part = 0; part < 4; ++part) {
      work.now += 0.25 * cost;
      if (const auto left = work.remaining.left(work.now)) said.emplace_back(work.now, *left);
      by_share.emplace_back(work.now, (work.now - begin) * (1.0 / written - 1.0));
    }
    work.progress.done(phase);
  };
  work.progress.expect("last", 1, 8.0);
  for (int round = 0; round < rounds; ++round) {
    const int to_come = rounds_known ? rounds - round : 2;  // else: this one, and one that finds nothing
    written = 0.2 + 0.6 * round / 8.0;
    work.progress.expect("questions", 40.0 * to_come, 0.1);
    work.progress.expect("fits", 6.0 * to_come, 1.0);
    for (int i = 0; i < 40; ++i) unit("questions", (1.0 + 0.2 * round) * question);
    for (int i = 0; i < 6; ++i) unit("fits", (1.0 + 0.2 * round) * fit);
  }
  work.progress.expect("questions", 0);
  work.progress.expect("fits", 0);
  written = 0.8;
  unit("last", last);
  return {against(said, begin, work.now), against(by_share, begin, work.now)};
}

}  // namespace

TEST_CASE("remaining time: equal units are foretold to the second once the first is done") {
  Watched work;
  work.progress.expect("units", 10, 3.0);
  CHECK_FALSE(work.remaining.left(work.now).has_value());
  for (int i = 0; i < 10; ++i) {
    work.progress.begin("units", "a unit");
    if (i > 0) CHECK(work.left() == doctest::Approx(2.0 * (10 - i)));
    work.now += 0.5;
    if (i > 0) CHECK(work.left() == doctest::Approx(2.0 * (10 - i) - 0.5));
    work.now += 1.5;
    work.progress.done("units");
  }
  CHECK(work.left() == 0.0);
}

TEST_CASE(
    "remaining time: a phase that has not begun costs its guess at the pace of what is done, then what it takes") {
  Watched work;
  work.progress.expect("small", 4, 1.0);
  work.progress.expect("large", 2, 10.0);
  work.progress.begin("small", "");
  work.now += 3.0;  // s per unit of weight
  work.progress.done("small");
  CHECK(work.left() == doctest::Approx(3.0 * 3.0 + 2.0 * 30.0));
  for (int i = 0; i < 3; ++i) {
    work.now += 3.0;
    work.progress.done("small");
  }
  work.progress.begin("large", "");
  work.now += 6.0;
  work.progress.done("large");
  // Four units of weight 1 and one of weight 10 took 18 s: the guess is 10 x 18 / 14 s, and has the weight of one unit
  // beside the one that took 6 s.
  CHECK(work.left() == doctest::Approx(0.5 * (10.0 * 18.0 / 14.0 + 6.0)));
}

TEST_CASE("remaining time: from a hundredth of the work nothing is foretold") {
  Watched work;
  work.progress.expect("small", 1);
  work.progress.expect("large", 1, 99.0);
  work.progress.begin("small", "");
  work.now += 1e-3;
  work.progress.done("small");
  CHECK_FALSE(work.remaining.left(work.now).has_value());
  work.progress.expect("large", 1, 40.0);
  CHECK(work.left() == doctest::Approx(40e-3));
}

TEST_CASE("remaining time: what stands longer than expected is never nearly done") {
  Watched work;
  work.progress.expect("fits", 3);
  work.progress.begin("fits", "");
  work.now += 10.0;
  work.progress.done("fits");
  work.progress.begin("fits", "");
  double before = work.left();
  CHECK(before == doctest::Approx(20.0));
  for (double age = 1.0; age <= 8.0; age += 1.0) {  // down to a second a second, up to four fifths of what was expected
    work.now += 1.0;
    CHECK(work.left() == doctest::Approx(before - 1.0));
    before = work.left();
  }
  for (int i = 0; i < 20; ++i) {
    work.now += 10.0;
    CHECK(work.left() > before);
    before = work.left();
  }
  CHECK(before == doctest::Approx(10.0 + 0.25 * 208.0));
}

TEST_CASE("remaining time: units that several threads finish count by the wall's clock") {
  Watched work;
  work.progress.expect("questions", 40);
  work.progress.begin("questions", "");
  for (int i = 0; i < 20; ++i) {  // four at a time, each 2 s
    if (i % 4 == 0) work.now += 2.0;
    work.progress.done("questions");
  }
  CHECK(work.left() == doctest::Approx(20 * 0.5).epsilon(0.1));
}

TEST_CASE("remaining time: recent units count more than those of long ago") {
  Watched work;
  work.progress.expect("fits", 200);
  for (int i = 0; i < 150; ++i) {
    work.progress.begin("fits", "");
    work.now += i < 75 ? 1.0 : 4.0;
    work.progress.done("fits");
  }
  CHECK(work.left() == doctest::Approx(50 * 4.0).epsilon(0.1));
}

TEST_CASE("remaining time: expectations may be revised at any time, and what was not announced is timed too") {
  Watched work;
  work.progress.begin("surprise", "");
  work.now += 4.0;
  work.progress.done("surprise");
  CHECK(work.left() == 0.0);
  work.progress.expect("surprise", 2);
  CHECK(work.left() == doctest::Approx(8.0));
  work.progress.expect("surprise", 0);
  CHECK(work.left() == 0.0);
  work.progress.begin("surprise", "");  // after all
  CHECK(work.left() == doctest::Approx(4.0));
}

TEST_CASE("remaining time: whatever is told, in whatever order, the answer is a number that is not negative") {
  std::mt19937_64 random{11};
  std::uniform_int_distribution<int> which{0, 3}, phase{0, 3};
  std::uniform_real_distribution<double> number{-5.0, 50.0};
  const char* names[] = {"a", "b", "c", "d"};
  for (int run = 0; run < 50; ++run) {
    Watched work;
    for (int i = 0; i < 200; ++i) {
      const char* name = names[phase(random)];
      switch (which(random)) {
        case 0:
          work.progress.expect(name, number(random), std::abs(number(random)));
          break;
        case 1:
          work.progress.begin(name, name);
          break;
        case 2:
          work.progress.done(name, number(random));
          break;
        default:
          work.now += std::max(number(random), 0.0);
      }
      const auto left = work.remaining.left(work.now);
      if (left) CHECK((std::isfinite(*left) && *left >= 0.0));
    }
  }
}

TEST_CASE("remaining time: drawn searches are foretold within a factor, mostly, and better than by written shares") {
  for (const bool rounds_known : {true, false}) {
    std::mt19937_64 random{1};
    std::vector<Foretold> measured, fixed;
    for (int i = 0; i < 200; ++i) {
      const Searched one = search(random, rounds_known);
      measured.insert(measured.end(), one.measured.begin(), one.measured.end());
      fixed.insert(fixed.end(), one.fixed.begin(), one.fixed.end());
    }
    const double early = share_within(measured, 0.1, 3.0), late = share_within(measured, 0.5, 2.0);
    MESSAGE(std::string{rounds_known ? "rounds known" : "rounds unknown"}
            << ": after a tenth within a factor of 3: " << early << " (by shares " << share_within(fixed, 0.1, 3.0)
            << "), after the half within 2: " << late << " (by shares " << share_within(fixed, 0.5, 2.0) << ")");
    CHECK(early > (rounds_known ? 0.9 : 0.8));
    CHECK(late > (rounds_known ? 0.8 : 0.5));
    CHECK(share_within(fixed, 0.1, 3.0) < early);
    CHECK(share_within(fixed, 0.5, 2.0) < late - 0.2);
  }
}

TEST_CASE("remaining time: said as finely as it is known") {
  CHECK(time_left(0.0) == "some seconds left");
  CHECK(time_left(7.9) == "some seconds left");
  CHECK(time_left(8.0) == "about 10 s left");
  CHECK(time_left(84.0) == "about 80 s left");
  CHECK(time_left(86.0) == "about 1.5 min left");
  CHECK(time_left(250.0) == "about 4 min left");
  CHECK(time_left(584.0) == "about 9.5 min left");
  CHECK(time_left(600.0) == "about 10 min left");
  CHECK(time_left(1300.0) == "about 20 min left");
  CHECK(time_left(6800.0) == "about 115 min left");
  CHECK(time_left(9100.0) == "about 2.5 h left");
}

TEST_CASE("progress: a handle that nobody listens to is silent") {
  const Progress nobody;
  nobody.expect("phase", 3);
  nobody.begin("phase", "something");
  nobody.done("phase");
}

}  // namespace fathom
