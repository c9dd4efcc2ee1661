#include "common/board/roll.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace fathom::board {
namespace {

Health word(const std::string& name, int pid, const std::string& state = "running",
            const std::string& host = "vehicle") {
  return {.process = name, .host = host, .pid = pid, .state = state};
}

}  // namespace

TEST_CASE("roll: who is silent for longer than the sheriff waits is called silent, with the age of the last word") {
  Roll roll;
  roll.hear(word("estimator", 1), 10.0);
  CHECK(roll.entries(12.9).at(0).state == "running");
  CHECK(roll.entries(12.9).at(0).healthy);
  const auto silent = roll.entries(14.2).at(0);
  CHECK(silent.state == "silent");
  CHECK(silent.detail == "no HEALTH for 4 s");
  CHECK(silent.age == doctest::Approx(4.2));
  CHECK_FALSE(silent.healthy);
  roll.hear(word("estimator", 1), 20.0);
  CHECK(roll.entries(20.0).at(0).healthy);
}

TEST_CASE("roll: who has stopped in order is not silent") {
  Roll roll;
  roll.hear(word("estimator", 1, "stopped"), 10.0);
  CHECK(roll.entries(100.0).at(0).state == "stopped");
  roll.hear(word("vision", 2, "fault"), 10.0);
  CHECK(roll.entries(100.0).at(1).state == "fault");
  CHECK_FALSE(roll.entries(100.0).at(1).healthy);
}

TEST_CASE("roll: two of one name that speak in turn are told, on one host or on two, until one of them ends") {
  for (const std::string host : {"vehicle", "topside"}) {
    Roll roll;
    double t = 0.0;
    for (; t < 5.0; t += 1.0) {
      roll.hear(word("estimator", 1), t);
      roll.hear(word("estimator", 2, "running", host), t + 0.5);
    }
    const auto both = roll.entries(t);
    REQUIRE(both.size() == 2);
    for (const auto& each : both) {
      CHECK(each.second);
      CHECK_FALSE(each.healthy);
      CHECK(each.detail.starts_with("a second process of this name speaks on this bus"));
    }
    roll.hear(word("estimator", 2, "stopped", host), t);
    roll.hear(word("estimator", 1), t);
    const auto left = roll.entries(t);
    REQUIRE(left.size() == (host == "vehicle" ? 1 : 2));
    CHECK(std::none_of(left.begin(), left.end(), [](const auto& each) { return each.second; }));
  }
}

TEST_CASE("roll: one that was killed and started again is the same process, started again once") {
  Roll roll;
  roll.hear(word("estimator", 1), 0.0);
  roll.hear(word("estimator", 2), 0.8);  // the old one's word is not yet three seconds old
  CHECK(roll.entries(0.9).size() == 1);
  CHECK(roll.entries(0.9).at(0).health.pid == 2);
  CHECK(roll.entries(0.9).at(0).healthy);
  for (double t = 1.8; t < 6.0; t += 1.0) roll.hear(word("estimator", 2), t);
  REQUIRE(roll.entries(6.0).size() == 1);
  CHECK(roll.entries(6.0).at(0).returns == 1);
  roll.hear(word("estimator", 3), 20.0);
  CHECK(roll.entries(20.0).at(0).returns == 2);
}

TEST_CASE("roll: a flood of names does not grow it, nor drive out those who go on speaking") {
  Roll roll;
  for (int i = 0; i < 10'000; ++i) {
    roll.hear(word("made up " + std::to_string(i), i), 1e-3 * i);
    if (i % 20 == 0) roll.hear(word("estimator", 1), 1e-3 * i);
  }
  const auto all = roll.entries(10.0);
  CHECK(all.size() == Roll::kMost);
  CHECK(std::any_of(all.begin(), all.end(), [](const auto& each) { return each.health.process == "estimator"; }));
}

}  // namespace fathom::board
