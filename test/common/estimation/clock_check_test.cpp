// Of sensors that disagree about the time, the one is named that all others disagree with.
#include "common/estimation/online/clock_check.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "common/estimation/online/navigator.hpp"
#include "test/common/estimation/survey_runs.hpp"

using namespace fathom;
using namespace fathom::estimation;

namespace {

constexpr std::array kNames{"TAGS", "FLOW", "DEPTH"};
constexpr double kStated = 0.1, kGap = 0.25;  // s

/// What is said after `seconds` in which the channels come so much older than the newest attitude.
std::string said(const std::array<double, 3>& age, double seconds, std::size_t heard = 3) {
  ClockCheck check;
  for (int i = 0; i <= static_cast<int>(20.0 * seconds); ++i) {
    const Utime now = utime_after(1'700'000'000'000'000, 0.05 * i);
    for (std::size_t c = 0; c < heard; ++c) check.hear(c, utime_after(now, -age[c]), age[c], kStated, kGap);
  }
  const std::string attitude = check.attitude();
  return attitude.empty() ? check.odd_one(kNames) : attitude;
}

bool says(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// The trial's filter when the stamps of AHRS are `by` s off from the tenth second on.
std::string of_jumped_attitude(bool shallow, double by) {
  auto arrivals = test::synthetic_survey({.duration = 20.0, .shallow = shallow});
  for (auto& arrival : arrivals) {
    if (auto* ahrs = std::get_if<Ahrs>(&arrival.sample); ahrs != nullptr && ahrs->utime > 1'010'000'000)
      ahrs->utime = utime_after(ahrs->utime, by);
  }
  Navigator navigator{test::survey_settings(shallow), test::survey_places()};
  (void)test::feed(navigator, arrivals);
  return navigator.complaint();
}

}  // namespace

TEST_CASE("clocks: who is as old as stated is no matter") {
  CHECK(said({0.05, 0.1, 0.0}, 10.0).empty());
  CHECK(said({0.3, 0.1, 0.0}, 10.0).empty());   // late, and hardly: it is counted, no more
  CHECK(said({-0.2, 0.0, 0.0}, 10.0).empty());  // an attitude sensor with a low rate
}

TEST_CASE("clocks: the one that disagrees with all others is named") {
  CHECK(says(said({0.05, 2.0, 0.05}, 10.0), "FLOW comes 1.9 s later than stated"));
  CHECK(says(said({0.05, -2.0, 0.05}, 10.0), "FLOW is 2 s ahead of AHRS"));
  CHECK(says(said({-0.5, -0.45, -0.5}, 10.0), "AHRS is 0.45 s behind the other sensors"));
  CHECK(says(said({0.5, 0.45, 0.5}, 10.0), "the clock of AHRS ahead"));
  CHECK(says(said({-0.5, 0.0, 0.0}, 10.0, 1), "TAGS is 0.5 s ahead of AHRS"));  // of two nobody can tell whose it is
}

TEST_CASE("clocks: the more is tolerated of a channel, the later it is named") {
  ClockCheck check;
  for (int i = 0; i < 100; ++i) {
    const Utime now = utime_after(1'700'000'000'000'000, 0.05 * i);
    check.hear(0, utime_after(now, -1.0), 1.0, kStated, kGap);
    check.hear(1, utime_after(now, -0.05), 0.05, kStated, kGap);
  }
  CHECK(check.attitude().empty());
  CHECK(says(check.odd_one(kNames), "TAGS comes 0.9 s later than stated"));
  CHECK(says(check.odd_one(kNames, std::array{0.8}), "TAGS"));
  CHECK(check.odd_one(kNames, std::array{1.0}).empty());
}

TEST_CASE("clocks: what lasts for a moment is a busy machine") {
  CHECK(said({2.0, 2.0, 2.0}, 1.0).empty());
  CHECK(said({-2.0, -2.0, -2.0}, 1.0).empty());
}

TEST_CASE("clocks: an attitude sensor whose clock jumps is named by the trial's filter, in the tank and in the deep") {
  for (const bool shallow : {true, false}) {
    CAPTURE(shallow);
    CHECK(of_jumped_attitude(shallow, 0.0).empty());
    CHECK(says(of_jumped_attitude(shallow, -0.8), "AHRS is"));
    CHECK(says(of_jumped_attitude(shallow, -0.8), "behind the other sensors"));
    CHECK(says(of_jumped_attitude(shallow, 0.6), "the clock of AHRS ahead"));
  }
}
