#include "common/likelihood/run_data.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

TEST_CASE("run data: isolated spikes go, steps and bursts stay") {
  std::vector<double> series(400);
  for (std::size_t k = 0; k < series.size(); ++k) {
    series[k] = std::sin(0.05 * static_cast<double>(k)) + 1e-3 * std::sin(17.0 * static_cast<double>(k * k));
    if (k >= 200) series[k] += 0.5;
  }
  CHECK(isolated_spikes(series).empty());
  series[100] += 0.3;
  series[300] -= 0.2;
  CHECK(isolated_spikes(series) == std::vector<std::size_t>{100, 300});
}

TEST_CASE("run data: a held sample enters once, and what shares a block with it is averaged without it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  auto dive = test::fly(vehicle, {.duration = 10.0});
  Trial& trial = dive.trial;
  for (std::size_t k = 1; k < trial.size(); k += 2) trial.nu[k].head<3>() = trial.nu[k - 1].head<3>();
  const RunData run{trial, vehicle, {}};
  CHECK(run.held() == trial.size() / 2);
  REQUIRE(run.block_size() == 2);
  const Block& block = run.blocks()[10];  // samples 21 and 22, of which 21 is held
  CHECK(block.n[0] == 1.0);
  CHECK(block.y[0] == trial.nu[22][0]);
  CHECK(block.lag[0] == 0.0);
  CHECK(block.walk[0] == 1.0);
  CHECK(block.n[5] == 2.0);
  CHECK(block.lag[5] == doctest::Approx(0.25));
  CHECK(block.walk[5] == doctest::Approx((0.5 + 3 * 0.5 + 0.5) / 4.0));
  CHECK(block.n[4] == 0.0);  // pitch is not simulated
}
