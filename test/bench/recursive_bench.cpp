// What one update of the on-line identification costs: 13 parameters, 4 equations, estimate projected on its signs.
#include <benchmark/benchmark.h>

#include <array>
#include <random>
#include <vector>

#include "common/identification/integral_regressor.hpp"
#include "common/identification/recursive.hpp"
#include "common/model/regressor.hpp"

namespace {

using namespace fathom;
using namespace fathom::identification;
using Block = std::array<Row, 4>;

constexpr int kParameters = 13;
constexpr std::array<int, kParameters> kColumns{0, 1, 2, 5, 6, 7, 8, 11, 12, 13, 14, 17, 18};
constexpr std::array<int, 4> kAxes{0, 1, 2, 5};

// Rows of random motion; with `contrary`, Y_v is of the wrong sign, so that the projection has work to do.
std::vector<Block> random_rows(bool contrary) {
  std::mt19937 engine{1};
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, kParameters, 1> theta;
  theta << 9.8, 8.7, 10.9, 0.16, -8.6, contrary ? 3.0 : -18.1, -17.2, -1.4, -17.9, -1.1, -3.6, -10.3, -1.2;
  std::vector<Block> blocks(512);
  for (Block& block : blocks) {
    Vector6d nu;
    Vector6d nu_dot;
    for (int i = 0; i < 6; ++i) {
      nu(i) = 0.4 * normal(engine);
      nu_dot(i) = 0.2 * normal(engine);
    }
    const model::BaseRegressor Y = model::base_regressor(nu_dot, nu, Eigen::Matrix3d::Identity());
    for (std::size_t a = 0; a < 4; ++a) {
      block[a].axis = kAxes[a];
      block[a].h.resize(kParameters);
      for (int i = 0; i < kParameters; ++i) block[a].h(i) = Y(kAxes[a], kColumns[static_cast<std::size_t>(i)]);
      block[a].y = block[a].h.dot(theta) + 0.1 * normal(engine);
      block[a].variance = 0.01;
    }
  }
  return blocks;
}

void update(benchmark::State& state, bool contrary, double forgetting) {
  const std::vector<Block> blocks = random_rows(contrary);
  RecursiveSettings settings;
  settings.mean = ParameterVector::Zero(kParameters);
  settings.sigma = ParameterVector::Constant(kParameters, 100.0);
  settings.forgetting = forgetting;
  for (std::size_t i = 0; i < 12; ++i) settings.signs[i] = i < 4 ? 1 : -1;
  RecursiveEstimator estimator{settings};
  std::size_t k = 0;
  for (auto _ : state) {
    estimator.step(blocks[k++ % blocks.size()]);
    ParameterVector x = estimator.projected();
    benchmark::DoNotOptimize(x);
  }
}

void update_admissible(benchmark::State& state) { update(state, false, 1.0); }
void update_forgetting(benchmark::State& state) { update(state, false, 0.9998); }
void update_projected(benchmark::State& state) { update(state, true, 1.0); }
BENCHMARK(update_admissible);
BENCHMARK(update_forgetting);
BENCHMARK(update_projected);

void integral_rows(benchmark::State& state) {
  IntegralSettings settings;
  settings.dof = {true, true, true, false, false, true};
  for (const int i : kColumns) settings.parameters.push_back(static_cast<model::BaseParameter>(i));
  settings.stride = 0.01;  // rows at every sample
  IntegralRegressor regressor{settings};
  MotionSample sample;
  sample.valid = true;
  sample.nu.setConstant(0.1);
  for (auto _ : state) {
    sample.utime += 100'000;  // 10 Hz: 20 samples in a window
    benchmark::DoNotOptimize(regressor.step(sample));
  }
}
BENCHMARK(integral_rows);

}  // namespace
