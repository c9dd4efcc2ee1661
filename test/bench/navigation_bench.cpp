// One step of the trial's estimator: prediction with an attitude sample, corrections, and the whole mind with its
// memory.
#include <benchmark/benchmark.h>

#include "common/estimation/online/complementary_filter.hpp"
#include "common/estimation/online/navigation_filter.hpp"
#include "common/estimation/online/navigator.hpp"

using namespace fathom;
using namespace fathom::estimation;

namespace {

NavigationFilter filter() {
  NavigationFilter f{{0.01, 0.002, 0.05}};
  f.start(Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Zero(), 0.1);
  return f;
}

void predict(benchmark::State& state) {
  NavigationFilter f = filter();
  const Eigen::Matrix3d R = Eigen::AngleAxisd{0.3, Eigen::Vector3d::UnitZ()}.toRotationMatrix();
  for (auto _ : state) {
    f.predict(1e-9, R, {0.0, 0.0, -9.81});
    benchmark::DoNotOptimize(f);
  }
}
BENCHMARK(predict);

void predict_and_correct_velocity(benchmark::State& state) {
  NavigationFilter f = filter();
  const Eigen::Matrix3d R = Eigen::AngleAxisd{0.3, Eigen::Vector3d::UnitZ()}.toRotationMatrix();
  for (auto _ : state) {
    const Gains k = second_order_gains(4.0, 3.0, 0.033);
    const AxisGains gains{Eigen::Vector3d::Constant(k.value), Eigen::Vector3d::Constant(k.rate), {}};
    f.predict(1e-9, R, {0.0, 0.0, -9.81});
    f.correct_velocity({0.001, 0.002, 0.0}, gains, Eigen::Vector3d::Constant(1e-4), R);
    benchmark::DoNotOptimize(f);
  }
}
BENCHMARK(predict_and_correct_velocity);

void navigator(benchmark::State& state) {
  NavigatorSettings s{.attitude_noise = 0.002,
                      .rate_noise = 0.002,
                      .acceleration_noise = 0.01,
                      .bias_walk = 0.002,
                      .bias_prior = 0.05,
                      .largest_position_sigma = 1.0,
                      .largest_velocity_sigma = 1.0};
  s.usbl = {.used = true, .cutoff = 0.1, .vertical_cutoff = 0.1, .delay = 0.05, .max_age = 10.0};
  s.dvl = {.used = true, .cutoff = 2.0, .vertical_cutoff = 2.0, .noise = 0.01, .delay = 0.05, .max_age = 1.0};
  Navigator mind{s, {}};
  Ahrs ahrs{.utime = 1'000'000,
            .f_B = {0.0, 0.0, -9.81},
            .has_rates = true,
            .has_specific_force = true,
            .has_attitude = true};
  (void)mind.step(Usbl{.utime = 1'000'000, .sigma = Eigen::Vector3d::Constant(0.1)});
  int k = 0;
  for (auto _ : state) {
    ahrs.utime += 10'000;
    ahrs.f_B.x() = 1e-6 * (++k % 7);
    if (k % 12 == 0)
      benchmark::DoNotOptimize(mind.step(Dvl{.utime = ahrs.utime - 30'000, .v_WB_B = {1e-4 * (k % 5), 0.0, 0.0}}));
    benchmark::DoNotOptimize(mind.step(ahrs));
  }
}
BENCHMARK(navigator);

}  // namespace
