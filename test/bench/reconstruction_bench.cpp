// Trials reconstructed, and terms selected: what the same work costs in numpy is measured by reconstruction.py beside.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "common/estimation/smoothing/trial_smoother.hpp"
#include "common/identification/regression/block_bootstrap.hpp"
#include "common/identification/regression/stepwise.hpp"

namespace {

using namespace fathom;

/// 330 s of an inertial package at 100 Hz, heading and depth at 10 Hz, four ranges at 1 Hz.
Recording recording_330() {
  std::mt19937 random{1};
  std::normal_distribution<double> normal;
  Recording r;
  r.name = "bench";
  for (int k = 0; k < 33000; ++k) {
    const double t = 0.01 * k, yaw = 0.1 * t;
    const Utime utime = 1'700'000'000'000'000 + 10'000 * static_cast<Utime>(k);
    Ahrs ahrs{.utime = utime, .has_rates = true, .has_specific_force = true};
    ahrs.w_WB_B =
        Eigen::Vector3d(0.0, 0.0, 0.1) + 0.005 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    ahrs.f_B =
        Eigen::Vector3d(0.0, 0.05, -9.80665) + 0.05 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    if (k % 10 == 0) {
      ahrs.q_WB = Eigen::Quaterniond{Eigen::AngleAxisd(yaw + 0.02 * normal(random), Eigen::Vector3d::UnitZ())};
      ahrs.has_attitude = true;
      r.depth.push_back({utime, 3.0 + 0.02 * normal(random)});
    }
    r.ahrs.push_back(ahrs);
    if (k % 100 != 0) continue;
    const Eigen::Vector3d p{5.0 * std::sin(yaw), 5.0 - 5.0 * std::cos(yaw), 3.0};
    Ranges ranges{.utime = utime};
    for (const Eigen::Vector3d& T : {Eigen::Vector3d(20, 0, 8), Eigen::Vector3d(0, 20, 8), Eigen::Vector3d(-9, -9, 8),
                                     Eigen::Vector3d(15, 15, 9)}) {
      ranges.range.push_back((p - T).norm() + 0.1 * normal(random));
      ranges.valid.push_back(1);
    }
    r.ranges.push_back(ranges);
  }
  return r;
}

estimation::KalmanSettings settings_18() {
  estimation::KalmanSettings s;
  s.biases = false;
  s.attitude = estimation::AttitudeUse::kHeading;
  s.transponders = {{"A", {20, 0, 8}}, {"B", {0, 20, 8}}, {"C", {-9, -9, 8}}, {"D", {15, 15, 9}}};
  return s;
}

void kalman_filter_330_s(benchmark::State& state) {
  const Recording recording = recording_330();
  const estimation::KalmanSettings settings = settings_18();
  for (auto _ : state) benchmark::DoNotOptimize(estimation::likelihood(recording, settings));
}
void kalman_smoother_330_s(benchmark::State& state) {
  const Recording recording = recording_330();
  const estimation::KalmanSettings settings = settings_18();
  for (auto _ : state) benchmark::DoNotOptimize(estimation::smooth(recording, settings));
}
BENCHMARK(kalman_filter_330_s)->Unit(benchmark::kMillisecond);
BENCHMARK(kalman_smoother_330_s)->Unit(benchmark::kMillisecond);

Eigen::MatrixXd samples_33000() {
  std::mt19937 random{2};
  std::normal_distribution<double> normal;
  Eigen::MatrixXd z(33000, 41);
  for (int j = 0; j < 40; ++j) {
    double slow = 0.0;
    for (int k = 0; k < 33000; ++k) z(k, j) = slow = 0.99 * slow + 0.1 * normal(random);
  }
  double e = 0.0;
  for (int k = 0; k < 33000; ++k) {
    e = 0.9 * e + normal(random);
    z(k, 40) = 2.0 * z(k, 0) - 3.0 * z(k, 7) + 1.5 * z(k, 11) + z(k, 23) + 2.0 * z(k, 31) + e;
  }
  return z;
}

constexpr int kBlock = 200;

void gram_33000_x_41(benchmark::State& state) {
  const Eigen::MatrixXd z = samples_33000();
  for (auto _ : state) {
    identification::LaggedGram gram{41};
    gram.add(z, kBlock);
    benchmark::DoNotOptimize(gram);
  }
}
void stepwise_33000_x_40(benchmark::State& state) {
  const Eigen::MatrixXd z = samples_33000();
  std::vector<std::string> names(40, "c");
  std::size_t terms = 0;
  for (auto _ : state) {
    identification::LaggedGram gram{41};
    gram.add(z, kBlock);
    std::vector<identification::LaggedGram> parts;
    parts.push_back(std::move(gram));
    terms = identification::stepwise(parts, names, {}).terms.size();
  }
  state.counters["terms"] = static_cast<double>(terms);
}
void bootstrap_1000(benchmark::State& state) {
  identification::LaggedGram gram{41};
  gram.add(samples_33000(), kBlock);
  for (auto _ : state)
    benchmark::DoNotOptimize(identification::block_bootstrap(gram, {0, 7, 11, 23, 31}, 0.9, 1000, 1));
}
BENCHMARK(gram_33000_x_41)->Unit(benchmark::kMillisecond);
BENCHMARK(stepwise_33000_x_40)->Unit(benchmark::kMillisecond);
BENCHMARK(bootstrap_1000)->Unit(benchmark::kMillisecond);

}  // namespace
