#include "common/consistency/pairs/shared_value.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace fathom::consistency {
namespace {

constexpr double kFreedom = 10;
constexpr double kFloor = 0.01;

std::vector<Estimate> estimates(std::initializer_list<double> values, double sigma) {
  std::vector<Estimate> list;
  for (const double value : values)
    list.push_back({.value = value, .sigma = sigma, .informative = true, .freedom = kFreedom});
  return list;
}

}  // namespace

TEST_CASE("shared value: what all recordings say is applied to all of them, silent ones too") {
  auto list = estimates({1.05, 1.06, 1.04}, 0.005);
  list.push_back({});  // says nothing
  const SharedValue shared = share(list, 1.0, kFloor);
  CHECK(shared.found);
  CHECK(shared.pooled.value == doctest::Approx(1.05));
  CHECK(shared.pooled.count == 3);
  REQUIRE(shared.applied.size() == 4);
  for (const double one : shared.applied) CHECK(one == shared.pooled.value);
  CHECK(shared.different.empty());
}

TEST_CASE("shared value: neutral where it is unsure, too small to matter, or not repeated") {
  const auto refused = [](const std::vector<Estimate>& list) {
    const SharedValue shared = share(list, 1.0, kFloor);
    CHECK(shared.applied == std::vector<double>(list.size(), 1.0));
    return !shared.found;
  };
  CHECK(refused({}));
  CHECK(refused(estimates({1.05, 1.06, 1.04}, 0.05)));     // one sigma
  CHECK(refused(estimates({1.005, 1.006, 1.004}, 1e-4)));  // sure, and below the floor
  CHECK(refused(estimates({1.08, 0.96}, 0.02)));           // two recordings that may contradict each other
  auto silent = estimates({1.05, 1.06}, 0.005);
  for (Estimate& one : silent) one.informative = false;
  CHECK(refused(silent));
}

TEST_CASE("shared value: few blocks of data know their own scatter badly, so more is asked of them") {
  auto list = estimates({1.05}, 0.01);
  list[0].freedom = 100;
  CHECK(share(list, 1.0, kFloor).found);  // 5 sigmas against 4.5
  list[0].freedom = 5;
  CHECK_FALSE(share(list, 1.0, kFloor).found);
  CHECK(share(list, 1.0, kFloor).limit > 10.0);
}

TEST_CASE("shared value: one recording unlike the others keeps its own, when the others are a majority") {
  const SharedValue shared = share(estimates({0.0, 0.001, 0.3, -0.001}, 0.002), 0.0, kFloor);
  CHECK_FALSE(shared.found);
  CHECK(shared.different == std::vector<std::size_t>{2});
  CHECK(shared.applied == std::vector<double>{0.0, 0.0, 0.3, 0.0});
  // One against one: nobody is the exception, nothing is shared, and each that is sure has its own.
  const SharedValue apart = share(estimates({0.0, 0.3}, 0.002), 0.0, kFloor);
  CHECK(apart.disagree);
  CHECK_FALSE(apart.found);
  CHECK(apart.applied == std::vector<double>{0.0, 0.3});
  CHECK(share(estimates({-0.47, 0.26}, 0.002), 0.0, kFloor).applied == std::vector<double>{-0.47, 0.26});
  // Its own uncertainty may explain the difference.
  auto unsure = estimates({0.0, 0.001, 0.3, -0.001}, 0.002);
  unsure[2].sigma = 0.1;
  CHECK(share(unsure, 0.0, kFloor).different.empty());
}

}  // namespace fathom::consistency
