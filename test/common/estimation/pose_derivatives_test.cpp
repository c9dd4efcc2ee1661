// Velocities out of poses whose stamps lie unevenly, and what is done where some are missing.
#include "common/estimation/pose_derivatives.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/estimation/run_signals.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kDuration = 120.0;  // s
constexpr double kStart = 2.0;       // s, the motion's 0 on the recording's clock

struct Derived {
  PoseSeries pose;
  PoseDerivatives slopes;
  double velocity{}, rates{};  // m/s, rad/s: root mean square of what separates them from the truth, per axis
  double late{};               // s from the motion's 0 to the first stamp
};

Derived derive(test::SyntheticOptions options) {
  options.seed = 3;
  options.duration = kDuration;
  options.pose_rate = 50.0;
  options.position_noise = 0.001;
  const Recording recording = test::synthetic_recording(options);
  std::vector<ConsistencyFinding> findings;
  const RunSignals run = read_signals(recording, findings);
  CHECK(findings.empty());
  Derived derived{.pose = run.pose, .slopes = differentiate(run.pose)};
  derived.late = seconds_between(utime_after(0, kStart), run.origin);
  const test::SyntheticMotion motion(options.seed);
  const auto error = [&](const Series& series, auto truth) {
    double square = 0.0;
    for (std::size_t i = 0; i < series.size(); ++i)
      square += (series.x[i] - truth(series.t[i] + derived.late)).squaredNorm();
    return std::sqrt(square / 3.0 / static_cast<double>(series.size()));
  };
  derived.velocity = error(derived.slopes.velocity.series, [&](double t) { return motion.v_B(t); });
  derived.rates = error(derived.slopes.rates.series, [&](double t) { return motion.w_B(t); });
  return derived;
}

/// Share of the poses that have a velocity.
double covered(const Derived& derived) {
  return static_cast<double>(derived.slopes.velocity.series.size()) / static_cast<double>(derived.pose.size());
}

}  // namespace

TEST_CASE("pose derivatives: steps of 10 to 30 ms cost nothing") {
  const Derived even = derive({}), uneven = derive({.uneven = 0.5});
  CHECK(uneven.velocity < 1.15 * even.velocity);
  CHECK(uneven.rates < 1.15 * even.rates);
  CHECK(covered(uneven) > 0.98);
  for (int k = 0; k < 3; ++k) {
    CHECK(uneven.slopes.velocity.sigma[k] == doctest::Approx(even.slopes.velocity.sigma[k]).epsilon(0.1));
    CHECK(uneven.slopes.rates.sigma[k] == doctest::Approx(even.slopes.rates.sigma[k]).epsilon(0.1));
  }
}

TEST_CASE("pose derivatives: a lost sample in twenty costs no more than itself") {
  const Derived whole = derive({}), torn = derive({.missing = 0.05});
  CHECK(torn.velocity < 1.15 * whole.velocity);
  CHECK(covered(torn) > 0.97);
}

TEST_CASE("pose derivatives: nothing is said beside a gap, nor beside a pose that is not believed") {
  Derived whole = derive({});
  PoseSeries pose = whole.pose;
  const auto from = static_cast<std::ptrdiff_t>(2500), to = static_cast<std::ptrdiff_t>(2550);  // 50 to 51 s
  const auto cut = [&](auto& values) { values.erase(values.begin() + from, values.begin() + to); };
  cut(pose.t);
  cut(pose.p_WB);
  cut(pose.q_WB);
  cut(pose.valid);
  pose.valid[1000] = 0;  // 20 s
  const std::vector<double> t = differentiate(pose).velocity.series.t;
  const auto any = [&](double low, double high) {
    return std::ranges::any_of(t, [&](double one) { return one > low && one < high; });
  };
  const double reach = t.front();  // of the window
  CHECK_FALSE(any(50.0 - reach + 0.01, 51.0 + reach - 0.03));
  CHECK(any(50.0 - reach - 0.05, 50.0 - reach + 0.01));
  CHECK_FALSE(any(20.0 - reach + 0.01, 20.0 + reach - 0.01));
  CHECK(any(20.0 + reach, 20.0 + reach + 0.05));
}

}  // namespace fathom::estimation
